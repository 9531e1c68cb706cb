"""Shell pipes with what they print: each folder here holds a `cmd`, its `expout` and `experr`.

Numbers agree to nine digits, since the mathematics library of another machine may round
differently; all else is equal to the letter. A case is made by running its cmd with bash in an
empty directory, with SAMPLES naming the folder samples/, and reading what came out.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from conftest import Result, assert_alike

HERE = Path(__file__).parent
CASES = sorted(path.parent.name for path in HERE.glob("*/cmd"))


@pytest.mark.parametrize("case", CASES)
def test_a_pipe_prints_what_it_should(
    case: str, users_shell: Callable[..., Result], samples: Path
) -> None:
    folder = HERE / case
    result = users_shell((folder / "cmd").read_text("utf-8"))
    assert_alike(result.out, (folder / "expout").read_text("utf-8"))
    reported = result.err.replace(str(samples), "SAMPLES")
    assert_alike(reported, (folder / "experr").read_text("utf-8"))
