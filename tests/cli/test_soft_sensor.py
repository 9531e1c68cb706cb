"""`scarid simulate --soft-sensor`."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from conftest import Result

Run = Callable[..., Result]
TRAJECTORY = "scarid trajgen -q --seed 1"


def test_how_well_the_loop_follows_is_told(shell: Run) -> None:
    done = shell(f"{TRAJECTORY} | scarid simulate --soft-sensor p2smd,gamma0=50 -o /dev/null")
    assert done.status == 0, done.err
    assert "with p2smd,gamma0=50 in the loop, tracking errors and changes" in done.err
    assert "rad and" in done.err
    assert "N m, joint 2" in done.err


@pytest.mark.parametrize(
    ("sensor", "status", "words"),
    [
        ("rts", 2, "rts needs later rows, which a controller does not have; give a causal"),
        ("nope", 2, "no method 'nope'; there are 2smd, "),
        ("p2smd,gamma=3", 2, "--soft-sensor gamma=3: p2smd has no setting 'gamma'"),
        ("p2smd,preset=no", 2, "--soft-sensor: p2smd has no preset 'no'"),
        (",p2smd", 2, "--soft-sensor: no method ''"),
        ("2smd", 65, "the closed loop does not follow its reference; its soft sensor is too slow"),
    ],
)
def test_what_cannot_close_the_loop_is_refused(
    shell: Run, sensor: str, status: int, words: str
) -> None:
    done = shell(
        f"{TRAJECTORY} | scarid simulate -q --control computed-torque --soft-sensor {sensor}"
        " -o log.parquet"
    )
    assert done.status == status
    assert words in done.err
    assert done.err.count("\n") == 1
