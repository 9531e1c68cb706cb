"""Shell pipes with what they print: each folder here holds a `cmd`, its `expout` and `experr`.

Numbers agree to nine digits, since the mathematics library of another machine may round
differently; all else is equal to the letter. A case is made by running its cmd with bash in an
empty directory, with SAMPLES naming the folder samples/, and reading what came out.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from conftest import Result

HERE = Path(__file__).parent
CASES = sorted(path.parent.name for path in HERE.glob("*/cmd"))
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+\.?\d*(?:e[-+]?\d+)?(?![\w.])")


def assert_alike(found: str, expected: str) -> None:
    """Equal texts, but for the last digits of numbers."""
    assert NUMBER.sub("#", found) == NUMBER.sub("#", expected)
    numbers = [float(x) for x in NUMBER.findall(found)]
    assert numbers == pytest.approx([float(x) for x in NUMBER.findall(expected)], 1e-9, 1e-12)


@pytest.mark.parametrize("case", CASES)
def test_a_pipe_prints_what_it_should(
    case: str, shell: Callable[..., Result], samples: Path
) -> None:
    folder = HERE / case
    result = shell((folder / "cmd").read_text("utf-8"))
    assert_alike(result.out, (folder / "expout").read_text("utf-8"))
    told = result.err.replace(str(samples), "SAMPLES")
    assert_alike(told, (folder / "experr").read_text("utf-8"))
