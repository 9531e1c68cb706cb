"""The blind procedure as a function is the one that `scarid identify` runs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import gauntlet
import pytest
from conditions import Condition
from conditions import log as simulated
from conftest import Result

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.io.table import Table
from scarid_cli.io.writer import Output, all_or_none
from scarid_cli.stages.differentiate import matched
from scarid_cli.stages.procedure import blind
from scarid_cli.stages.procedure.recommended import smoothed_motion

Run = Callable[..., Result]
PLAIN = Condition("plain", duration=8.0)
SLOWER = Condition("torques read seldom", {"torque-rate": (50.0,)}, duration=8.0)
SEED = 50_000


@pytest.fixture
def robot() -> Robot:
    return load("scara2")


def written(table: Table, path: Path) -> bytes:
    """The bytes of a table as a command writes them, without a history."""
    output = Output(str(path))
    with all_or_none([output]):
        output.take(replace(table, meta=replace(table.meta, history=())))
    return path.read_bytes()


def held(table: Table) -> Callable[[], Table]:
    """The same table, as often as it is asked for."""
    batches = list(table.batches)
    return lambda: replace(table, batches=iter(batches))


def motion(robot: Robot, log: Table) -> Table:
    return smoothed_motion(log, robot).motion


def speeds(robot: Robot, log: Table) -> Table:
    """A motion of which nothing is known, as it comes from elsewhere."""
    smoother = smoothed_motion((again := held(log))(), robot).smoother
    found = matched(again(), [smoother] * len(robot.joints))
    return replace(found, meta=replace(found.meta, extra={}))


def as_it_is(robot: Robot, log: Table) -> Table:
    return log


@pytest.mark.parametrize(
    ("conditions", "seen"),
    [
        pytest.param([PLAIN], as_it_is, id="a measurement"),
        pytest.param([SLOWER], as_it_is, id="a slower sensor"),
        pytest.param([PLAIN, PLAIN], as_it_is, id="two logs"),
        pytest.param([PLAIN, SLOWER], as_it_is, id="one of two has a slower sensor"),
        pytest.param([PLAIN], motion, id="a motion"),
        pytest.param([PLAIN], speeds, id="a motion from elsewhere"),
        pytest.param([PLAIN, PLAIN], motion, id="two motions"),
    ],
)
def test_the_command_and_the_function_give_the_same_bytes(
    conditions: Sequence[Condition],
    seen: Callable[[Robot, Table], Table],
    robot: Robot,
    scarid: Run,
    tmp_path: Path,
) -> None:
    logs = [
        held(seen(robot, simulated(robot, condition, SEED + k)))
        for k, condition in enumerate(conditions)
    ]
    files = [tmp_path / f"{k}.parquet" for k in range(len(logs))]
    for log, file in zip(logs, files, strict=True):
        written(log(), file)
    of_command = tmp_path / "command.parquet"
    done = scarid("identify", "--robot", "scara2", "--no-history", *files, "-o", of_command)
    assert done.status == 0, done.err
    found = blind.identified([log() for log in logs], robot)
    assert written(found, tmp_path / "function.parquet") == of_command.read_bytes()


@pytest.mark.parametrize("condition", [PLAIN, SLOWER], ids=lambda condition: condition.name)
def test_the_gauntlet_judges_what_the_command_finds(
    condition: Condition, robot: Robot, tmp_path: Path
) -> None:
    """Slower sensors are interpolated there as well."""
    log = held(simulated(robot, condition, SEED))
    found, _ = gauntlet.blind("scara2", log())
    prepared = blind.prepared([log()], robot, blind.Choices())
    assert bool(prepared.slower[0]) == (condition is SLOWER)
    expected = blind.estimated(prepared, robot, {})
    assert written(found, tmp_path / "a.parquet") == written(expected, tmp_path / "b.parquet")


@pytest.mark.parametrize(
    ("choices", "of_measurement", "of_motion"),
    [
        (blind.Choices(), ("gls", True), ("rls", False)),
        (blind.Choices(align=False), ("gls", False), ("rls", False)),
        (blind.Choices(estimator="wls"), ("wls", True), ("wls", False)),
        (blind.Choices(estimator="rls"), ("rls", True), ("rls", False)),
        (blind.Choices(settings={"weights": 0}), ("rls", True), ("rls", False)),
        (blind.Choices(estimator="ekf"), ("ekf", False), ("ekf", False)),
    ],
    ids=str,
)
def test_what_is_not_chosen_is_chosen_by_what_the_log_is(
    choices: blind.Choices, of_measurement: tuple[str, bool], of_motion: tuple[str, bool]
) -> None:
    for chosen, expected in (
        (choices.of_measurement(), of_measurement),
        (choices.of_motion(), of_motion),
    ):
        assert (chosen.name, chosen.treatment.align) == expected
