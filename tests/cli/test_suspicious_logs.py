"""Logs that wrong parameters explain well: the verdict says what is wrong with them."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from conftest import ROOT, Result
from unit.arms import seven_axes

from scarid_cli.algorithms.checks import units
from scarid_cli.algorithms.checks.finding import FAILED, WARNING
from scarid_cli.algorithms.checks.log import Log
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.stages.remarks.glance import of_extremes
from scarid_cli.stages.remarks.reach import Reach

Run = Callable[..., Result]

UR10E = ROOT / "samples" / "robots"


def verdict(result: Result) -> str:
    found = re.search(
        r"^scarid identify: ((?:good|rough|doubtful|not identifiable): .*)$", result.err, re.M
    )
    assert found, result.err
    return found[1]


def spoiled(log: Path, path: Path, factors: dict[str, float]) -> Path:
    """The log with some columns multiplied."""
    names, *rows = log.read_text("utf-8").splitlines()
    scales = [factors.get(name, 1.0) for name in names.split(",")]
    cells = (
        ",".join(
            x if scale == 1.0 else str(float(x) * scale)
            for x, scale in zip(row.split(","), scales, strict=True)
        )
        for row in rows
    )
    path.write_text("\n".join([names, *cells, ""]))
    return path


@pytest.mark.parametrize(
    ("factors", "told"),
    [
        ({}, "good: "),
        (
            {"q2": -1.0, "tau2": -1.0},
            "doubtful: axes: the model fits far better with the position and the torque of joint ",
        ),
        (
            {"tau2": -1.0},
            "doubtful: signs: the model fits far better with the torque of joint 2 reversed; "
            "multiply the torque of joint 2 by -1: ",
        ),
        ({"q1": 57.3, "q2": 57.3}, "doubtful: positions: joints 1, 2 up to 8"),
        ({"q1": 1000.0}, "doubtful: positions: joint 1 at "),
    ],
)
def test_a_check_that_fails_makes_the_verdict_doubtful(
    factors: dict[str, float], told: str, samples: Path, tmp_path: Path, scarid: Run
) -> None:
    log = spoiled(samples / "scara2.csv", tmp_path / "log.csv", factors)
    assert verdict(scarid("identify", "--robot", "scara2", log)).startswith(told)


def test_a_position_that_was_logged_twice_is_told(
    samples: Path, tmp_path: Path, scarid: Run
) -> None:
    rows = [line.split(",") for line in (samples / "scara2.csv").read_text("utf-8").splitlines()]
    one, two = (rows[0].index(name) for name in ("q1", "q2"))
    log = tmp_path / "log.csv"
    copied = [[*row[:two], row[one], *row[two + 1 :]] for row in rows[1:]]
    log.write_text("\n".join(",".join(row) for row in [rows[0], *copied]) + "\n")
    said = verdict(scarid("identify", "--robot", "scara2", log))
    assert said.startswith("doubtful: equal positions: q2 is q1 in all 501 rows")


@pytest.mark.parametrize(
    ("factors", "told"),
    [
        ({}, "good: "),
        ({"dq1": 57.29578, "dq2": 57.29578}, "doubtful: velocities: 57.3, 57.3 times the changes"),
        ({"dq1": -1.0}, "doubtful: velocities: the velocity of joint 1 has the other sign"),
        ({"dq1": 2.0, "dq2": 2.0}, "doubtful: clock: velocities 2, 2 times the changes"),
        ({"dq1": 0.8, "dq2": 0.8}, ""),  # as of a soft sensor that smooths too much
    ],
)
def test_velocities_of_a_motion_are_changes_of_its_positions(
    factors: dict[str, float], told: str, samples: Path, tmp_path: Path, scarid: Run
) -> None:
    motion = tmp_path / "motion.csv"
    scarid("differentiate", "--method", "rts", samples / "scara2.csv", "-o", motion)
    found = verdict(scarid("identify", "--robot", "scara2", spoiled(motion, motion, factors)))
    assert found.startswith(told)
    assert told or "velocities" not in found.partition("; ")[0]


def test_a_reversed_torque_of_a_joint_that_moves_no_other_is_told(
    tmp_path: Path, scarid: Run
) -> None:
    """The model fits as well with an inertia and friction below 0."""
    pytest.importorskip("pinocchio")
    robot, reference, log = (tmp_path / name for name in ("l.urdf", "r.csv", "l.csv"))
    robot.write_text(LIFT)
    scarid("trajgen", "--robot", robot, "--ddq-max", "10,3", "--duration", 10, "-o", reference)
    scarid("simulate", "--robot", robot, reference, "-o", log)
    spoiled(log, log, {"tau1": -1.0})
    told = verdict(scarid("identify", "--robot", robot, log))
    assert told.startswith("doubtful: the inertia of joint 1 is negative")


LIFT = """<robot name="lift"><link name="base"/>
<joint name="turn" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
<limit lower="-2" upper="2" effort="50" velocity="5"/></joint>
<link name="arm"><inertial><origin xyz="0.2 0 0"/><mass value="5"/>
<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="lift" type="prismatic"><parent link="arm"/><child link="fork"/><axis xyz="0 0 1"/>
<origin xyz="0.4 0 0"/><limit lower="-0.2" upper="0.2" effort="99" velocity="1"/></joint>
<link name="fork"><inertial><mass value="3"/>
<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""


def test_a_log_without_noise_or_friction_gives_no_doubt(tmp_path: Path, scarid: Run) -> None:
    """A mass below 0 and a large motor would move the lift as well if its axis were reversed.

    Friction and motors are 0, so that the errors of their parameters are those of rounding.
    """
    pytest.importorskip("pinocchio")
    robot, reference, log = (tmp_path / name for name in ("l.urdf", "r.parquet", "l.parquet"))
    robot.write_text(LIFT)
    scarid("trajgen", "--robot", robot, "--ddq-max", "10,5", "--seed", "1", "-o", reference)
    scarid("simulate", "--robot", robot, reference, "-o", log)
    assert verdict(scarid("identify", "--robot", robot, log)).startswith("good: ")


@pytest.mark.parametrize("degrees", [0.0, 5.0])
def test_a_tilted_base_is_named(degrees: float, tmp_path: Path, scarid: Run) -> None:
    pytest.importorskip("pinocchio")
    upright = UR10E / "ur10e.toml"
    gravity = -9.81 * np.array([np.sin(np.deg2rad(degrees)), 0.0, np.cos(np.deg2rad(degrees))])
    tilted = tmp_path / "tilted.toml"
    description = upright.read_text("utf-8").replace('"ur10e.urdf"', f'"{UR10E / "ur10e.urdf"}"')
    tilted.write_text(f"gravity = {gravity.tolist()}\n{description}")
    reference, log = tmp_path / "reference.parquet", tmp_path / "log.parquet"
    for words in (
        ("trajgen", "--robot", tilted, "--seed", "1", "-o", reference),
        ("simulate", "--robot", tilted, "--seed", "1", reference, "-o", log),
    ):
        assert scarid(*words).status == 0
    found = verdict(scarid("identify", "--robot", upright, log))
    stated = re.search(r"another direction than described.*gravity = \[(.*?)\] in the TOML", found)
    if degrees:
        assert stated, found
        found_gravity = [float(x) for x in stated[1].split(",")]
        np.testing.assert_allclose(found_gravity, gravity, atol=0.06)  # a third of a degree
        assert "a tilt by 5 +- 0" in found
        assert found.startswith("good: ")
    else:
        assert not stated


@pytest.mark.parametrize("share", [0.6, 0.75])
def test_a_clipped_torque_is_never_good(
    share: float, samples: Path, tmp_path: Path, scarid: Run
) -> None:
    table = pd.read_csv(samples / "scara2.csv")
    most = share * table["tau1"].abs().max()
    table["tau1"] = table["tau1"].clip(-most, most)
    table.to_csv(tmp_path / "log.csv", index=False)
    found = verdict(scarid("identify", "--robot", "scara2", tmp_path / "log.csv"))
    assert found.startswith("doubtful: saturation: the torque of joint 1 stays at its extreme in ")


@pytest.mark.parametrize("signals", [("tau",), ("q", "tau")])
def test_exchanged_joints_are_named(
    signals: tuple[str, ...], samples: Path, tmp_path: Path, scarid: Run
) -> None:
    table = pd.read_csv(samples / "scara2.csv")
    names = {f"{s}{j}": f"{s}{3 - j}" for s in signals for j in (1, 2)}
    table.rename(columns=names)[table.columns].to_csv(tmp_path / "log.csv", index=False)
    found = verdict(scarid("identify", "--robot", "scara2", tmp_path / "log.csv"))
    assert found.partition(": ")[0] in ("doubtful", "not identifiable")
    assert "order of joints: the model fits far better with " in found
    options = " ".join(f"--map {name}={other}" for name, other in names.items())
    assert f"`scarid convert {options}`" in found


@pytest.mark.parametrize("axes", [2, 3])
def test_a_tilt_has_more_columns_than_an_arm_may_have_axes(
    axes: int, tmp_path: Path, scarid: Run
) -> None:
    pytest.importorskip("pinocchio")
    (tmp_path / "arm.urdf").write_text(seven_axes(axes=axes))
    joint = (
        "[[joint]]\nacceleration_limit = 9.0\nencoder_resolution = 1e-5\ntorque_noise = 0.05\n"
        "terms = { inertia = 0.1, viscous = 0.5, coulomb = 0.6, offset = 0.0 }\n"
    )
    upright, tilted = (tmp_path / f"{name}.toml" for name in ("upright", "tilted"))
    upright.write_text(f'urdf = "arm.urdf"\n{axes * joint}')
    tilted.write_text(f"gravity = [1.7, 0.0, -9.66]\n{upright.read_text()}")
    log = tmp_path / "log.parquet"
    assert scarid("trajgen", "--robot", tilted, "--seed", "1", "-o", tmp_path / "r.csv").status == 0
    assert scarid("simulate", "--robot", tilted, tmp_path / "r.csv", "-o", log).status == 0
    found = verdict(scarid("identify", "--robot", upright, log))
    told = re.search(r"a tilt by ([\d.]+) \+- ", found)
    assert told, found
    assert float(told[1]) == pytest.approx(10.0, abs=0.3)


@pytest.mark.parametrize(("factor", "unit"), [(1000.0, "mN m"), (0.001, "kN m"), (1.0, None)])
def test_torques_in_another_unit_are_told_from_the_a_priori_parameters(
    factor: float, unit: str | None, samples: Path, tmp_path: Path, scarid: Run
) -> None:
    """The description of this robot has no limits of the torques."""
    factors = dict.fromkeys(("tau1", "tau2"), factor)
    log = spoiled(samples / "scara2.csv", tmp_path / "log.csv", factors)
    result = scarid("identify", "--robot", "scara2", log)
    told = re.findall(r" scale: .*? `scarid convert --unit 'tau\*=(.*?)'`", result.err)
    assert told == ([unit] if unit else [])


@pytest.mark.parametrize(
    ("factors", "told"),
    [
        ((1e3, 1.0, 1.0, 1.0), "to be in mm: `scarid convert --unit q1=mm`"),
        ((1.0, 1.0, 57.3, 1.0), "degrees: `scarid convert --unit q3=deg`, or `--unit q2=deg --uni"),
        ((1.0, 57.3, 57.3, 57.3), "degrees: `scarid convert --unit q2=deg --unit q3=deg --unit q4"),
        ((1e3, 57.3, 57.3, 57.3), "mm and degrees: `scarid convert --unit q1=mm --unit q2=deg --"),
    ],
)
def test_joints_have_units_of_their_type(factors: tuple[float, ...], told: str) -> None:
    """A rail that carries an arm of three joints."""
    arm = load("scara2")
    turn = replace(arm.joints[0], lower=-2.0, upper=2.0, velocity_limit=3.0)
    rail = replace(turn, type="prismatic")
    robot = replace(arm, joints=(rail, turn, turn, turn))
    q = np.array([1.5, 1.5, 1.2, 1.8])[:, None] * np.array(factors)[:, None] * [[-1.0, 1.0]]
    (found,) = of_extremes(q, np.ones((4, 2)), robot, 0.005)
    assert (found.name, found.status) == ("positions", FAILED)
    assert told in found.advice


@pytest.mark.parametrize(
    ("q", "speed", "told"),
    [
        ((-0.1, 2.9), 2.0, ""),
        ((-0.1, 2.9), 30.0, "joint 1 at 10 times the velocity limit"),  # a placeholder in a URDF
        ((-2.9, 0.1), 2.0, "joint 1 at 2.81 times the limits"),  # an axis that points the other way
        ((-5.7, 170.0), 100.0, "joint 1 up to 170, far outside the limits"),
    ],
)
def test_positions_as_large_as_their_limits_are_in_no_other_unit(
    q: tuple[float, float], speed: float, told: str
) -> None:
    arm = load("scara2")
    one = replace(arm.joints[0], lower=-0.1, upper=3.0, velocity_limit=3.0)
    robot = replace(arm, joints=(one, replace(one, lower=-2.0)))
    log = Log(np.zeros(2), np.array([q, (-1.0, 1.0)]), np.ones((2, 2)))
    found, factors = units.positions(log, robot, np.array([speed, 1.0]))
    degrees = "far outside" in told
    assert found.status == (FAILED if degrees else WARNING if told else "ok")
    assert found.figure.startswith(told)
    assert ("scarid convert" in found.advice) == (factors[0] != 1.0) == degrees


def test_joints_without_limits_may_turn_many_times() -> None:
    """The pendulum of the gauntlet whirls: positions in degrees are only suspected."""
    turns = np.array([[-1.0, 53.0], [-50.0, 2.0]])
    torques = np.array([[-5.0, 5.0], [-2.0, 2.0]])
    (found,) = of_extremes(turns, torques, load("planar2-gravity"), 0.005)
    assert (found.name, found.status) == ("positions", WARNING)
    (found,) = of_extremes(turns, torques, load("scara2"), 0.005)
    assert (found.name, found.status) == ("positions", FAILED)


@pytest.mark.parametrize(("torque", "status"), [(20.0, None), (0.02, FAILED), (2.0, None)])
def test_torques_in_kilonewton_metres_are_told(torque: float, status: str | None) -> None:
    """Of motors that give 40 N m: 20 N m are usual, and 0.02 can only be kN m."""
    robot = load("scara2")
    robot = replace(robot, joints=tuple(replace(j, torque_limit=40.0) for j in robot.joints))
    reach = Reach(2)
    reach.high = np.array([1.0, 1.0, torque, 0.5 * torque])
    reach.low = -reach.high
    found = reach.findings(robot, 0.005)
    assert [finding.status for finding in found] == [status] * (status is not None)
    assert all("torques seem to be in kN m" in finding.advice for finding in found)


@pytest.mark.parametrize(
    ("factors", "told"),
    [
        ({}, None),
        ({"q1": 57.3, "q2": 57.3}, "positions seem to be in degrees: `scarid convert --unit 'q*"),
        ({"q1": 1000.0}, "is this the robot, and is a position that of the motor"),
    ],
)
def test_another_unit_is_the_verdict_of_validate(
    factors: dict[str, float], told: str | None, samples: Path, tmp_path: Path, scarid: Run
) -> None:
    """Of an arm with other inertias, as it would otherwise seem."""
    log, found = samples / "scara2.csv", tmp_path / "parameters.parquet"
    scarid("identify", "-q", "--robot", "scara2", log, "-o", found)
    other = spoiled(log, tmp_path / "log.csv", factors)
    verdict = scarid("validate", "--parameters", found, other).err.splitlines()[-1]
    assert ("unexplained: positions: " in verdict) == (told is not None)
    assert told is None or told in verdict


@pytest.mark.parametrize(
    ("command", "told"),
    [
        ("resample --rate 100", "the time seems to be in ms: `scarid convert --unit t=ms`"),
        ("differentiate", "the time seems to be in ms: `scarid convert --unit t=ms`"),
        ("filter --cutoff 0.01", "the time seems to be in ms: `scarid convert --unit t=ms`"),
        ("filter", "cutoff 20 Hz is not below half the rate, 0.05 Hz; is the time in seconds?"),
    ],
)
def test_a_time_in_milliseconds_is_told(
    command: str, told: str, samples: Path, tmp_path: Path, scarid: Run
) -> None:
    log = spoiled(samples / "scara2.csv", tmp_path / "log.csv", {"t": 1e3})
    assert told in scarid(*command.split(), log, "-o", tmp_path / "out.csv").err


@pytest.mark.parametrize("limit", [3.0e5, 0.004])
def test_a_limit_that_is_a_placeholder_is_no_reason_for_doubt(
    limit: float, tmp_path: Path, scarid: Run
) -> None:
    """The masses need just these torques; of torques in another unit they do not."""
    log, lifted = tmp_path / "log.csv", tmp_path / "lifted.csv"
    reference, robot = tmp_path / "reference.csv", tmp_path / "arm.urdf"
    made = (ROOT / "samples" / "arm.urdf").read_text("utf-8")
    words = ("--seed", 3, "--ddq-max", 10)
    robot.write_text(made)
    scarid("trajgen", "-q", "--robot", robot, *words, "-o", reference)
    scarid("simulate", "-q", "--robot", robot, reference, "-o", log)
    robot.write_text(re.sub(r'effort="[^"]*"', f'effort="{limit}"', made))
    found = tmp_path / "parameters.parquet"
    assert verdict(scarid("identify", "--robot", robot, log, "-o", found)).startswith("good")
    checked = scarid("check", "--robot", robot, log)
    assert "failed" not in checked.out.replace("0 failed", "")
    same = scarid("validate", "--parameters", found, log).err
    assert "unchanged" in same
    spoiled(log, lifted, {"tau1": 1e3, "tau2": 1e3})
    assert not verdict(scarid("identify", "--robot", robot, lifted)).startswith("good")
