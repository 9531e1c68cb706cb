"""Torques in another unit, all joints alike: no log in one is called good."""

from __future__ import annotations

import pytest
from conftest import ROOT, Shell

MADE = {
    "planar2-gravity": "--q-max 2,2 --ddq-max 20,30",
    str(ROOT / "samples" / "arm.toml"): "",
}


def scaled(shell: Shell, robot: str, factor: float) -> str:
    """What `identify` says of a log whose torques are multiplied."""
    done = shell(
        f"scarid trajgen -q --robot {robot} --seed 4 {MADE[robot]} --duration 12 |"
        f" scarid simulate -q --robot {robot} --seed 4 --format csv | cut -d, -f-5 |"
        f" awk -F, -v OFS=, 'NR > 1 {{ $4 *= {factor}; $5 *= {factor} }} 1' > log.csv;"
        f" scarid identify --robot {robot} log.csv -o p.parquet"
    )
    return done.err


@pytest.mark.parametrize("factor", [0.03, 0.3, 3.0, 30.0])
@pytest.mark.parametrize("robot", MADE, ids=["planar2-gravity", "arm"])
def test_torques_in_another_unit_are_never_good(robot: str, factor: float, shell: Shell) -> None:
    told = scaled(shell, robot, factor)
    assert "scarid identify: good: " not in told
    assert "scale: the torques are " in told


@pytest.mark.parametrize("factor", [0.8, 1.0, 1.25])
@pytest.mark.parametrize("robot", MADE, ids=["planar2-gravity", "arm"])
def test_masses_that_are_a_little_off_make_nothing_doubtful(
    robot: str, factor: float, shell: Shell
) -> None:
    told = scaled(shell, robot, factor)
    assert "scarid identify: good: " in told, told


def test_torques_of_one_joint_out_of_scale_point_to_what_else_it_may_be(shell: Shell) -> None:
    """They may be those of another joint, for which `check` searches, and `identify` does not."""
    robot = str(ROOT / "samples" / "arm.toml")
    scaled(shell, robot, 1.0)
    log = "awk -F, -v OFS=, 'NR > 1 { $5 *= 10 } 1' log.csv"
    done = shell(f"{log} | scarid identify --robot {robot} -o p.parquet")
    assert "scale: the torque of joint 2 is " in done.err
    assert done.err.count("`scarid check LOG` looks for the cause") == 1
    checked = shell(f"{log} | scarid check --robot {robot}")
    assert "looks for the cause" not in checked.out + checked.err
