"""What a model that has the parameters alone lacks: each kind of addition has its sentence."""

from __future__ import annotations

import pytest
from conftest import ROOT

from scarid_cli.algorithms.beyond.additions import Addition
from scarid_cli.algorithms.beyond.catalogue import MISMATCHES, SHAPES
from scarid_cli.algorithms.beyond.mounting import Tilt
from scarid_cli.algorithms.beyond.torques import Offset, RelativeGain, Spring
from scarid_cli.algorithms.inference.sentences import left_out_of
from scarid_cli.algorithms.robots.reading import load

ARM = load(str(ROOT / "samples" / "robots" / "ur10e.toml"))
NAMES = [
    *(name for name in SHAPES if name not in (RelativeGain.NAME, Offset.NAME)),
    Tilt.NAME,
    *MISMATCHES,
]


@pytest.mark.parametrize("name", NAMES)
def test_each_addition_is_named_with_its_joint(name: str) -> None:
    pytest.importorskip("pinocchio")
    addition = Addition(name, 1, 1.0, 0.02, cycles=4.0, error=0.001)
    (note,) = left_out_of(dict.fromkeys(ARM.names, 1.0), [addition], ARM)
    assert "gravity = [" in note if name == Tilt.NAME else "joint 2" in note


def test_a_gain_is_that_of_a_torque_constant_and_a_slack_spring_is_said_once() -> None:
    pytest.importorskip("pinocchio")
    additions = [
        Addition(RelativeGain.NAME, 2, 1.0, 0.05),
        Addition(Spring.NAME, 1, 1.0, 9.0),
        Addition(Offset.NAME, 1, 1.0, 2.0),
    ]
    gain, spring = left_out_of(dict.fromkeys(ARM.names, 1.0), additions, ARM)
    assert "joint 3 was logged as 1.05 times" in gain
    assert "joint 2" in spring
