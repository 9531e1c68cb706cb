"""The command urdf: identified parameters into a copy of a URDF."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from cli.real import described_six_axes
from conftest import Result, refused
from pyarrow.parquet import read_table
from unit.arms import URDF, seven_axes, sines

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.arrays import Array

Run = Callable[..., Result]
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
    write_motion(tmp_path / "motion.csv", robot, rng.uniform(-2.0, 2.0, (3, 2, 300)), 0.1)
    return tmp_path


def write_motion(path: Path, robot: Robot, motion: Array, noise: float | Array) -> None:
    """A motion (3, joints, samples) at 100 Hz, with the torques of the a priori parameters."""
    tau = robot.torques(robot.regressor(*motion), robot.apriori)
    tau += np.random.default_rng(0).normal(0.0, noise, tau.T.shape).T
    signals = [*motion.reshape(-1, motion.shape[2]), *tau]
    columns = np.column_stack((np.arange(motion.shape[2]) * 0.01, *signals))
    joints = range(1, len(tau) + 1)
    header = ",".join(["t", *(f"{name}{i}" for name in ("q", "dq", "ddq", "tau") for i in joints)])
    np.savetxt(path, columns, delimiter=",", header=header, comments="")


@pytest.fixture
def here(scarid: Run, folder: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    """Run one command line in the folder, in this process, which has loaded pinocchio."""
    monkeypatch.chdir(folder)
    return lambda line: scarid(*line.split()[1:])


IDENTIFY = "scarid identify -q --robot arm.toml --estimator wls motion.csv -o p.csv"


def test_an_identified_urdf_is_a_robot_with_the_identified_parameters(
    folder: Path, shell: Shell
) -> None:
    result = shell(
        f"{IDENTIFY} && scarid urdf --parameters p.csv --base near.csv arm.toml -o new.urdf &&"
        " scarid validate --robot arm.toml --parameters near.csv motion.csv | cut -d, -f1,2"
    )
    assert result.status == 0, result.err
    assert "no parameter moved by more than" in result.err
    assert "identify -o parameters.parquet" in result.err
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


def test_the_identified_base_set_is_written_out(folder: Path, here: Run) -> None:
    assert here(IDENTIFY).status == 0
    rows = [line.split(",") for line in (folder / "p.csv").read_text("utf-8").splitlines()[:2]]
    assert [(row[0], row[8]) for row in rows] == [
        ("parameter", "stands_for"),
        ("Iyy1", "Iyy1 + 0.09 m2"),
    ]


@pytest.mark.parametrize(
    ("command", "status", "message"),
    [
        ("--parameters p.csv emps", 2, "emps: has no URDF to write parameters into"),
        ("--parameters p.csv arm.urdf", 65, "expected those of arm.urdf"),
        ("--parameters none.csv arm.toml", 2, "none.csv: no such file"),
        ("--parameters p.csv arm.toml -o /nowhere/new.urdf", 74, "/nowhere"),
        ("--parameters p.csv --skip 5 arm.toml", 2, "need --motion FILE"),
        ("--parameters p.csv --smooth-sign 0.1 arm.toml", 2, "need --motion FILE"),
    ],
)
def test_wrong_use_is_refused_in_one_line(
    command: str, status: int, message: str, folder: Path, here: Run
) -> None:
    assert here(IDENTIFY).status == 0
    refused(here(f"scarid urdf {command}"), status, message)


def test_r2_of_a_motion_is_reported_before_and_after(folder: Path, shell: Shell) -> None:
    """As `validate` computes it, with the same rows."""
    rows = "--skip 10,20 --drop-slow 0.1"
    result = shell(
        f"{IDENTIFY} && scarid urdf --parameters p.csv --motion motion.csv {rows} --base near.csv"
        " arm.toml -o new.urdf && for p in p near; do scarid validate --robot arm.toml"
        f" --parameters $p.csv {rows} motion.csv | tail -n +2 | cut -d, -f2; done"
    )
    assert result.status == 0, result.err
    before, after = np.array(result.out.split(), dtype=float).reshape(2, 2)
    listed = (", ".join(f"{x:.3f}" for x in values) for values in (before, after))
    assert f"R2 of the identified parameters: {next(listed)}\n" in result.err
    assert f"R2 of the physically consistent ones: {next(listed)}\n" in result.err
    assert "warning" not in result.err


def test_the_covariance_saves_the_torques_of_correlated_parameters(
    tmp_path: Path, shell: Shell
) -> None:
    """Seven axes, five slow seconds: CSV has no covariance, R2 collapses, and users are warned."""
    (tmp_path / "arm.urdf").write_text(seven_axes())
    (tmp_path / "true.urdf").write_text(seven_axes(centre="0.03 -0.04 0.05"))
    true = load(str(tmp_path / "true.urdf"))
    motion = sines(7, 250, 0.3, 1)
    deviation = 0.1 * true.torques(true.regressor(*motion), true.apriori).std(axis=1)
    write_motion(tmp_path / "motion.csv", true, motion, deviation)
    lines = {}
    for kind in ("csv", "parquet"):
        result = shell(
            f"scarid identify -q --robot arm.urdf --estimator wls motion.csv -o p.{kind} &&"
            f" scarid urdf --parameters p.{kind} --motion motion.csv arm.urdf -o new.urdf"
        )
        assert result.status == 0, result.err
        lines[kind] = result.err
    assert "warning: R2 falls substantially on this motion" in lines["csv"]
    assert "no covariance of the estimates" in lines["csv"]
    assert "warning" not in lines["parquet"]
    assert "covariance 69 by 69 numbers" in shell("scarid info p.parquet").out
    parameters = read_table(tmp_path / "p.parquet")
    covariance = np.array(json.loads(parameters.schema.metadata[b"scarid"])["extra"]["covariance"])
    robust, classical = (parameters[f"{kind}_error"].to_numpy() for kind in ("robust", "standard"))
    # Alternatives to the model widen each interval by itself, the covariance along a direction.
    assert np.median(robust**2 / np.diag(covariance)) == pytest.approx(1.0, rel=0.1)
    assert np.ptp(classical**2 / np.diag(covariance)) < 1e-9
    assert "Mahalanobis distance" in lines["parquet"]


def errors_of(path: Path) -> dict[str, float]:
    """The standard errors of all parameters before any were dropped."""
    table = read_table(path)
    covariance = json.loads(table.schema.metadata[b"scarid"])["extra"]["covariance"]
    return dict(zip(table["parameter"].to_pylist(), np.sqrt(np.diag(covariance)), strict=True))


def test_dropped_parameters_of_a_real_robot_stay_at_zero(
    shell: Shell, tmp_path: Path, real_logs: Path
) -> None:
    """Staubli TX40: only sums of inertias, which are positive, cannot be zero."""
    log = described_six_axes(real_logs, tmp_path) / "tx40_joint_5kHz.parquet"
    rows = "--skip 20,20 --decimate 10,10 --drop-slow 0.0501,0.0501,0.075,0.0716,0.0559,0.1222"
    result = shell(
        f"scarid filter --zero-phase --cutoff 100 -c 'q?' {log} --format arrow |"
        " scarid differentiate --method central --no-match -o motion.arrows &&"
        f" scarid identify -q --robot tx40.toml --estimator wls --essential {rows} motion.arrows"
        " -o p.parquet && scarid urdf --parameters p.parquet --base near.parquet"
        f" --motion motion.arrows {rows} tx40.toml -o new.urdf"
    )
    assert result.status == 0, result.err
    assert "warning" not in result.err
    estimated, near = (
        dict(zip(table["parameter"].to_pylist(), table["estimate"].to_pylist(), strict=True))
        for table in (read_table(tmp_path / f"{name}.parquet") for name in ("p", "near"))
    )
    dropped = [name for name, value in estimated.items() if value == 0.0]
    moved = {name for name in dropped if near[name] != 0.0}
    assert len(dropped) > 20
    assert "Izz5" in moved  # Izz5 + Iyy6
    assert len(moved) <= 6
    errors = errors_of(tmp_path / "p.parquet")
    assert all(abs(near[name]) < 2.0 * errors[name] for name in moved)


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
    refused(stale, 65, "give the robot that they were identified for")


def test_a_motion_that_is_none_is_refused_before_anything_is_reported(
    folder: Path, here: Run
) -> None:
    assert here(IDENTIFY).status == 0
    result = here("scarid urdf --parameters p.csv --motion p.csv arm.toml -o new.urdf")
    refused(result, 65, "p.csv, column t: found the columns")
    assert not (folder / "new.urdf").exists()


def test_consistent_estimates_are_those_of_rigid_bodies(folder: Path, here: Run) -> None:
    """A copy of the URDF with them has them, and `validate` finds nothing changed."""
    noisy = load(str(folder / "arm.toml"))
    write_motion(folder / "motion.csv", noisy, sines(2, 600, 2.0, 1), 0.5)
    done = here(f"{IDENTIFY.replace('p.csv', 'p.parquet')} --consistent")
    assert done.status == 0, done.err
    done = here("scarid urdf --parameters p.parquet --base near.csv arm.toml -o new.urdf")
    assert "no parameter moved by more than 0" in done.err or "e-" in done.err, done.err
    table = read_table(folder / "p.parquet")
    low, value, high = (table.column(n).to_numpy() for n in ("low", "estimate", "high"))
    assert np.all((low <= value) & (value <= high))
    known = np.array([name[:2] in ("fv", "fs") for name in table.column("parameter").to_pylist()])
    assert np.all(low[known] >= -1e-6)
    extra = json.loads(table.schema.metadata[b"scarid"])["extra"]
    assert extra["consistent"]["distance"] <= extra["consistent"]["explained"]
    done = here("scarid validate --robot arm.toml --parameters p.parquet motion.csv -q -o v.csv")
    assert done.status == 0, done.err


def test_consistent_needs_bodies(shell: Shell) -> None:
    done = shell(
        "scarid trajgen | scarid simulate | scarid differentiate | scarid identify --consistent"
    )
    assert done.status == 2
    assert "--consistent: scara2 is not described by bodies; it needs a robot of a URDF" in done.err
