"""What the tests with generated and mutated inputs share.

`make test` tries the same few examples each time. With SCARID_FUZZ=5000 (`make fuzz`), each test
tries so many, and others each time.
"""

from __future__ import annotations

import contextlib
import os
import signal
import tempfile
from collections.abc import Callable, Iterator
from types import FrameType
from typing import Any

from hypothesis import HealthCheck, settings
from hypothesis import strategies as st

from scarid_cli.errors import ScaridError

FEW = 60
LIMIT = 10.0  # s of processor time for one input, which takes milliseconds
NUMBERS = ["0", "1", "-1", "nan", "inf", "-inf", "1e308", "-1e308", "5e-324", "1_0", "0x1", "1e"]


def fuzzed(share: float = 1.0) -> Callable[[Any], Any]:
    """The settings of a test, whose inputs take so much longer (share < 1) than others."""
    wanted = os.environ.get("SCARID_FUZZ")
    return settings(
        max_examples=max(int(share * int(wanted or FEW)), 5),
        derandomize=not wanted,
        deadline=None,
        suppress_health_check=list(HealthCheck),
    )


@contextlib.contextmanager
def promptly() -> Iterator[None]:
    """Fail if the block takes too much processor time: the input makes its reader hang."""

    def stop(_number: int, _frame: FrameType | None) -> None:
        raise AssertionError("the input takes too long")

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, LIMIT)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


def understood(read: Callable[[], Any]) -> Any:
    """What a reader makes of an input; None if it refuses it as it should.

    Any other exception fails the test, as does a warning.
    """
    with promptly(), contextlib.suppress(ScaridError):
        return read()
    return None


@contextlib.contextmanager
def written(content: bytes, suffix: str = "") -> Iterator[str]:
    """The path of a file with this content."""
    with tempfile.NamedTemporaryFile(suffix=suffix) as file:
        file.write(content)
        file.flush()
        yield file.name


@st.composite
def mutated(draw: st.DrawFn, content: bytes, pieces: list[bytes]) -> bytes:
    """The content after some changes: bytes lost, repeated, or replaced by one of the pieces."""
    for _ in range(draw(st.integers(1, 4))):
        start = draw(st.integers(0, len(content)))
        end = draw(st.integers(start, min(start + 40, len(content))))
        kind = draw(st.sampled_from(["lost", "repeated", "replaced", "cut"]))
        new = draw(st.sampled_from(pieces) | st.binary(max_size=6))
        middle = {"lost": b"", "repeated": 2 * content[start:end], "replaced": new, "cut": b""}
        rest = b"" if kind == "cut" else content[end:]
        content = content[:start] + middle[kind] + rest
    return content
