"""The robot that a table states: found again where it was, and no file that a stranger names."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pyarrow.parquet as pq
import pytest
from conftest import Result, refused

from scarid_cli.algorithms.robots.reading import ROBOTS, load
from scarid_cli.errors import UsageFault

Run = Callable[..., Result]

EMPS = (ROBOTS / "emps.toml").read_text()


def experiment(scarid: Run, tmp_path: Path, robot: object) -> tuple[Path, Path]:
    """A motion of a robot, and its parameters; only the first command is told the robot."""
    names = [tmp_path / f"{name}.parquet" for name in ("trajectory", "log", "motion", "parameters")]
    trajectory, log, motion, parameters = names
    first = ("trajgen", "--robot", robot, "--duration", 5)
    assert scarid(*first, "-o", trajectory).status == 0
    for command, source, out in (
        ("simulate", trajectory, log),
        ("differentiate", log, motion),
        ("identify", motion, parameters),
    ):
        result = scarid(command, source, "-o", out)
        assert (result.status, "no robot is stated" in result.err) == (0, False)
    return motion, parameters


def test_a_description_in_a_file_is_found_again(scarid: Run, tmp_path: Path) -> None:
    robot = tmp_path / "mine.toml"
    robot.write_text(EMPS)
    motion, parameters = experiment(scarid, tmp_path, robot)
    assert scarid("validate", "--parameters", parameters, motion).status == 0
    history = scarid("info", parameters).out
    assert f"{robot}: sha256 " in history


def test_a_description_that_has_changed_must_be_stated(scarid: Run, tmp_path: Path) -> None:
    robot = tmp_path / "mine.toml"
    robot.write_text(EMPS)
    motion, parameters = experiment(scarid, tmp_path, robot)
    robot.write_text(EMPS.replace('title = "', 'title = "my '))
    validate = ("validate", "--parameters", parameters, motion)
    refused(scarid(*validate), 2, f"{parameters}: its robot is stated as {robot}", "--robot")
    assert scarid(*validate, "--robot", robot).status == 0
    robot.unlink()
    refused(scarid(*validate), 2, "--robot")


def test_the_environment_states_a_file_as_well(
    scarid: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot = tmp_path / "mine.toml"
    robot.write_text(EMPS)
    motion, parameters = experiment(scarid, tmp_path, robot)
    robot.write_text(f"{EMPS}\n# changed\n")
    monkeypatch.setenv("SCARID_ROBOT", str(robot))
    assert scarid("validate", "--parameters", parameters, motion).status == 0


@pytest.mark.parametrize("ending", [".toml", ".urdf"])
@pytest.mark.parametrize("inputs", ["{}", '{"FILE": null}', '{"FILE": "0123"}'])
def test_a_file_that_only_the_metadata_name_is_not_opened(
    ending: str, inputs: str, scarid: Run, tmp_path: Path, samples: Path
) -> None:
    target = tmp_path / f"secret{ending}"
    target.write_text("not a robot")
    entry = f'{{"command": "x", "version": "1", "inputs": {inputs}}}'.replace("FILE", str(target))
    log = tmp_path / "log.parquet"
    assert scarid("convert", samples / "scara2.csv", "-o", log).status == 0
    meta = {b"scarid": f'{{"robot": "{target}", "history": [{entry}]}}'.encode()}
    pq.write_table(pq.read_table(log).replace_schema_metadata(meta), log)
    for command in ("identify", "check"):
        refused(scarid(command, log), 2, f"{log}: its robot is stated as {target}", "--robot")
    assert scarid("identify", "--robot", "scara2", log, "-o", tmp_path / "p.csv").status == 0
    assert scarid("report", log, "--html", tmp_path / "r.html").status == 0


@pytest.mark.parametrize("name", ["../robots/scara2", "/etc/passwd", "a/b", "", "scara2\0", ".."])
def test_the_name_of_a_robot_leads_to_no_file(name: str) -> None:
    with pytest.raises(UsageFault, match="unknown robot"):
        load(name)
