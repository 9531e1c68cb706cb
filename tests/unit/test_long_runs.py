"""Four hours of noisy motion with long standstills, as a robot's shift has them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from unit.support import PERIOD

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.algorithms.processes.delays import reference
from scarid_cli.arrays import Array

LSB = 2.0 * np.pi / 2**13
CYCLES, CYCLE = 48, 300.0  # of five minutes each: moves, then standstill
MOVES, _, ACCELERATION = reference(PERIOD)
STARTING = 200  # rows


def shift() -> Iterator[Array]:
    """What an encoder reads cycle by cycle; at rest its last bit dithers."""
    rng = np.random.default_rng(0)
    rest = np.full(round(CYCLE / PERIOD) - len(MOVES), MOVES[-1])
    motion = np.concatenate((MOVES, rest)) + 0.4 * LSB
    for _ in range(CYCLES):
        yield LSB * np.round((motion + 0.3 * LSB * rng.standard_normal(len(motion))) / LSB)


def errors(method: Any) -> list[float]:
    """Of the acceleration over the motion of each cycle, until it diverges."""
    state, found = None, []
    for q in shift():
        state = state or method.init(float(q[0]), PERIOD)
        state, (_, a) = method.step(state, q)
        if not np.isfinite(a).all():
            break
        moving = a[STARTING : len(MOVES)] - ACCELERATION[STARTING:]
        found.append(float(np.sqrt(np.mean(moving**2))))
    return found


@pytest.mark.parametrize(
    ("name", "settings"),
    [("p2smd", {}), ("p2smd", {"implicit": 1}), ("2smd", {}), ("astd", {}), ("kalman", {})],
    ids=["p2smd", "p2smd implicit", "2smd", "astd", "kalman"],
)
def test_the_last_minute_of_motion_is_as_good_as_the_first(
    name: str, settings: dict[str, float]
) -> None:
    found = errors(DIFFERENTIATORS.load(name)(**settings))
    assert len(found) == CYCLES
    assert found[-1] == pytest.approx(found[0], rel=0.2)


def test_the_literal_law_of_p2smd_does_not_last() -> None:
    """Equation 9 lets its gains grow for ever; it diverges within minutes of standstill."""
    method = DIFFERENTIATORS.load("p2smd")
    found = errors(method(**method.PRESETS["table1"]))
    assert len(found) < CYCLES or found[-1] > 5.0 * found[0]
