"""Default settings that do not suit a log are reported at its end."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import pytest
from conftest import Result

Run = Callable[..., Result]


def log(place: Path, *, rate: float = 200.0, hertz: float = 0.5, step: float = 1e-5) -> Path:
    """Ten seconds of a sine of this frequency, seen by an encoder of this resolution [rad]."""
    rows = []
    for k in range(int(10.0 * rate)):
        q = step * round(math.sin(2.0 * math.pi * hertz * k / rate) / step)
        rows.append(f"{k / rate!r},{q!r},{math.cos(k / rate)!r}")
    place.write_text("\n".join(["t,q1,tau1", *rows]) + "\n")
    return place


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"step": 2e-3}, "a resolution of 0.002 rad"),
        ({"hertz": 8.0}, "the mean frequency of the estimated motion is"),
        ({"rate": 25.0}, "the rate of 25 Hz is low"),
    ],
)
def test_a_log_that_the_defaults_do_not_suit_is_reported(
    given: dict[str, float], said: str, tmp_path: Path, scarid: Run
) -> None:
    file = log(tmp_path / "log.csv", **given)
    result = scarid("differentiate", file)
    assert result.status == 0
    assert said in result.err
    assert "scarid tune --robot ROBOT LOG --save settings.toml" in result.err
    chosen = scarid("differentiate", "--set", "intensity=10000", file)
    assert chosen.err == ""
    assert chosen.out == result.out


def test_a_log_that_the_defaults_suit_is_not_reported(tmp_path: Path, scarid: Run) -> None:
    assert scarid("differentiate", log(tmp_path / "log.csv")).err == ""
