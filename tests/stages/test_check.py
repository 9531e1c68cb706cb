"""What `check` says of logs with known faults, and of clean ones."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from checks import LOGS, ROBOTS, URDF, clean, named, read, remarks
from checks_kinds import trial
from cli.real import TX40, ur10_log
from conftest import ROOT, long, seeds
from kinds import KINDS
from spoiled import SPOILED, Spoiled, torques_times, turned

from scarid_cli.algorithms.checks.finding import FAILED, OK, Finding, worst
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.stages.check import check

SIMULATED = {
    "scara, seed 2": ("scara", 2),
    "scara, seed 3 at 500 Hz": ("scara", 3, "--log-rate", "500"),
    "scara, 13 bits": ("scara", 4, "--encoder-bits", "13"),
    "emps": ("emps", 1),
    "emps at 1 kHz": ("emps", 2, "--log-rate", "1000"),
    "arm": ("arm", 1),
    "arm, seed 2": ("arm", 2),
    "pendulum": ("pendulum", 1),
    "ur10": ("ur10", 1),
}


def bad(found: list[Finding]) -> list[Finding]:
    return [finding for finding in found if finding.status != OK]


def present(robot: str) -> None:
    if robot in ("ur10", "panda") and not (URDF / f"{robot}.urdf").exists():
        pytest.skip("the URDF (../shared/data) is not here")


@pytest.mark.parametrize("name", SPOILED)
def test_a_fault_is_named(name: str) -> None:
    fault = SPOILED[name]
    present(fault.source)
    found = remarks(fault)
    assert named(fault, found), found


@pytest.mark.parametrize(
    "name", [name if k % 2 else pytest.param(name, marks=long) for k, name in enumerate(KINDS)]
)
def test_a_kind_of_fault_is_named_whatever_joint_and_size_are_drawn(name: str) -> None:
    fault, found = trial(name, KINDS[name], 2)
    assert named(fault, found), (fault.says, found)


@pytest.mark.parametrize("name", ["ur10", "panda"])
def test_reversed_torques_are_named_by_the_masses_where_there_is_no_friction(name: str) -> None:
    present(name)
    log = clean(name)
    every = Spoiled(
        name, torques_times(*[-1.0] * log.joints), "signs", "torques' sign seems reversed"
    )
    assert [found.name for found in remarks(every) if named(every, [found])] == ["signs"]


def test_scaled_torques_are_not_told_to_be_reversed() -> None:
    """Each in a unit of its own, they contradict the model: its friction may drive joints then."""
    for seed in seeds(1, 3):
        log = clean("ur10e", seed)
        factors = 0.1 * np.random.default_rng(seed).uniform(0.8, 1.25, log.joints)
        found = check(torques_times(*factors)(log), load(ROBOTS["ur10e"]))
        assert {finding.name for finding in found if finding.status == FAILED} == {"scale"}


@pytest.mark.parametrize("turn", [0.5 * np.pi, -0.5 * np.pi, np.pi])
def test_a_zero_that_estimated_masses_hide_is_told_by_the_described_ones(turn: float) -> None:
    """Seen from another zero the last link has another centre of mass: all else fits."""
    found = check(turned(2, turn)(clean("arm")), load(ROBOTS["arm"]))
    said = next(finding for finding in found if finding.name == "zeros")
    degrees = -np.degrees(turn) if turn < np.pi else 180.0
    assert f"the described masses fit far better with joint 2 at {degrees:.0f} " in said.figure


def test_a_joint_that_is_a_turn_away_from_its_zero_is_not_in_degrees() -> None:
    found = list(check(turned(2, 2.0 * np.pi)(clean("ur10e")), load(ROBOTS["ur10e"])))
    said = next(finding for finding in found if finding.name == "positions")
    assert "degrees" not in said.advice
    assert all(finding.name != "motion" for finding in bad(found))


def test_the_page_shows_the_faults_that_were_found() -> None:
    """The table of `make bench-checks` is that of docs/known-faults.md, but for the digits."""
    page = (ROOT / "docs" / "known-faults.md").read_text("utf-8")
    shown = [row.split("|")[1:4] for row in page.splitlines() if row.startswith("| ")]
    for name, fault in SPOILED.items():
        assert [f" {name} ", f" {LOGS[fault.source]} ", f" {fault.check} "] in shown


@pytest.mark.parametrize("joint", [1, 2])
def test_a_reversed_torque_is_named_where_the_model_still_explains_most(joint: int) -> None:
    """In this log the inertia of joint 2 hardly shows in the torque of joint 1."""
    spoil = torques_times(*(-1.0 if i == joint else 1.0 for i in (1, 2)))
    fault = Spoiled("scara", spoil, "signs", f"multiply the torque of joint {joint} by -1")
    found = list(check(spoil(clean("scara", 3)), load(ROBOTS["scara"])))
    assert named(fault, found), bad(found)


@pytest.mark.parametrize("name", SIMULATED)
def test_a_clean_simulated_log_is_not_called_worse_than_a_warning(name: str) -> None:
    robot, seed, *more = SIMULATED[name]
    present(str(robot))
    found = list(check(clean(str(robot), int(seed), *map(str, more)), load(ROBOTS[str(robot)])))
    assert worst(found) != FAILED, bad(found)


@pytest.mark.parametrize("name", ["emps", "tx40", "ur10"])
def test_a_real_log_is_not_called_worse_than_a_warning(
    name: str, real_logs: Path, tmp_path: Path
) -> None:
    robot, log = "emps", real_logs / "emps" / "emps_train.csv"
    if name == "tx40":
        folder = (real_logs / "staubli_tx40").resolve()
        description, log = tmp_path / "tx40.toml", folder / "tx40_joint_5kHz.parquet"
        description.write_text(TX40.format(folder=folder))
        robot = str(description)
    if name == "ur10":
        robot, log = str(URDF / "ur10.urdf"), tmp_path / "bag.csv"
        body = load(robot).body
        assert body
        bag = real_logs / "ur10_ros2" / "ur10_exciting_trajectory.db3"
        ur10_log(bag, body.joint_names, log)
    found = list(check(read(log, robot), load(robot)))
    assert worst(found) != FAILED, bad(found)
