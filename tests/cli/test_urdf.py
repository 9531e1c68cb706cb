"""The command urdf: identified parameters into a copy of a URDF."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from conftest import Result, refused
from unit.arms import URDF

from scarid_cli.algorithms.robots.reading import load

Shell = Callable[..., Result]

pytest.importorskip("pinocchio")
pytest.importorskip("cvxpy")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """An arm, and a motion of it whose torques are its own and friction."""
    (tmp_path / "arm.urdf").write_text(URDF.replace("TYPE", "revolute"))
    terms = "terms = { viscous = 2.0, coulomb = 0.5 }"
    (tmp_path / "arm.toml").write_text(
        f"title = 'arm'\nurdf = 'arm.urdf'\n[[joint]]\n{terms}\n[[joint]]\n{terms}\n"
    )
    robot = load(str(tmp_path / "arm.toml"))
    rng = np.random.default_rng(0)
    q, dq, ddq = rng.uniform(-2.0, 2.0, (3, 2, 300))
    tau = robot.torques(robot.regressor(q, dq, ddq), robot.apriori)
    tau += rng.normal(0.0, 0.1, tau.shape)
    columns = np.column_stack((np.arange(300) * 0.01, *q, *dq, *ddq, *tau))
    header = "t,q1,q2,dq1,dq2,ddq1,ddq2,tau1,tau2"
    np.savetxt(tmp_path / "motion.csv", columns, delimiter=",", header=header, comments="")
    return tmp_path


IDENTIFY = "scarid identify -q --robot arm.toml --estimator wls motion.csv -o p.csv"


def test_an_identified_urdf_is_a_robot_with_the_identified_parameters(
    folder: Path, shell: Shell
) -> None:
    result = shell(
        f"{IDENTIFY} && scarid urdf --parameters p.csv --base near.csv arm.toml -o new.urdf &&"
        " scarid validate --robot arm.toml --parameters near.csv motion.csv | cut -d, -f1,2"
    )
    assert result.status == 0, result.err
    assert "such bodies exist" in result.err
    assert "masses" in result.err
    for row in result.out.splitlines()[1:]:
        assert float(row.split(",")[1]) > 0.99
    old, new = load(str(folder / "arm.toml")), load(str(folder / "new.urdf"))
    apriori = dict(zip(old.names, old.apriori, strict=True))
    for name, value in zip(new.names, new.apriori, strict=True):
        if name[:2] not in ("Ia", "fv", "fs", "of"):
            assert value == pytest.approx(apriori[name], abs=0.05)
    text = (folder / "new.urdf").read_text()
    assert "scarid urdf arm.toml" in text
    assert 'damping="2.0' in text or 'damping="1.9' in text


def test_the_identified_base_set_is_written_out(folder: Path, shell: Shell) -> None:
    result = shell(f"{IDENTIFY} && cut -d, -f1,9 p.csv")
    assert result.out.splitlines()[:2] == ["parameter,stands_for", "Iyy1,Iyy1 + 0.09 m2"]


@pytest.mark.parametrize(
    ("command", "status", "told"),
    [
        ("--parameters p.csv emps", 2, "emps: has no URDF to put parameters into"),
        ("--parameters p.csv arm.urdf", 65, "expected those of arm.urdf"),
        ("--parameters none.csv arm.toml", 2, "none.csv: no such file"),
        ("--parameters p.csv arm.toml -o /nowhere/new.urdf", 74, "/nowhere"),
    ],
)
def test_what_cannot_be_is_told_in_one_line(
    command: str, status: int, told: str, folder: Path, shell: Shell
) -> None:
    refused(shell(f"{IDENTIFY} && scarid urdf {command}"), status, told)


def test_another_friction_model_needs_no_other_command(folder: Path, shell: Shell) -> None:
    """The description alone says which; identify and validate follow it."""
    commands = f"{IDENTIFY} && cut -d, -f1 p.csv | tail -n +2 | paste -sd ' ' &&" + (
        " scarid validate --robot arm.toml --parameters p.csv motion.csv | cut -d, -f3 | tail -2"
    )
    description = folder / "arm.toml"
    both = shell(commands)
    assert both.status == 0, both.err
    described = description.read_text()
    description.write_text(described.replace("terms = { viscous = 2.0, coulomb = 0.5 }",
                                             "terms = ['viscous']"))  # fmt: skip
    less = shell(commands)
    assert less.status == 0, less.err
    names, *errors = both.out.splitlines()
    fewer, *greater = less.out.splitlines()
    assert set(names.split()) - set(fewer.split()) == {"fs1", "fs2"}
    assert all(float(x) < 0.5 * float(y) for x, y in zip(errors, greater, strict=True))
    description.write_text(described)
    stale = shell("scarid validate --robot arm.toml --parameters p.csv motion.csv")
    refused(stale, 65, "choose the robot they were identified for")
