"""Measurements of real robots, identified with nothing set, against what is known of them."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable
from pathlib import Path

import pytest
from cli.real import TRAIN, described_six_axes, far_from_published, one_after_the_other, ur10_log
from conftest import Result

from scarid_cli.algorithms.robots.reading import load

Shell = Callable[..., Result]


@pytest.fixture
def six_axes(real_logs: Path, tmp_path: Path) -> Path:
    """The folder of the log, with a description of the robot in the working directory."""
    return described_six_axes(real_logs, tmp_path)


def identified(robot: str, log: object, shell: Shell) -> str:
    """Identify a measurement with nothing set, and validate on the motion that its pipe makes.

    Returns what identify reports. The working directory then has p.parquet, p.csv and m.csv.
    """
    result = shell(f"scarid identify --robot {robot} {log} -o p.parquet")
    assert result.status == 0, result.err
    found = re.search(r"the same as: (.* --format arrow \S+) \|", result.err)
    assert found
    judged = shell(
        f"{found[1]} | scarid validate --robot {robot} --parameters p.parquet -o m.csv &&"
        " scarid convert -q p.parquet -o p.csv"
    )
    assert judged.status == 0, judged.err
    return result.err


def rows_in(table: Path) -> list[dict[str, str]]:
    return list(csv.DictReader(table.read_text("utf-8").splitlines()))


def estimates_in(folder: Path) -> dict[str, float]:
    """The parameters in p.csv."""
    rows = rows_in(folder / "p.csv")
    return {row["parameter"]: float(row["estimate"]) for row in rows}


def r2_of(folder: Path) -> list[float]:
    """R2 of each joint in m.csv."""
    return [float(row["r2"]) for row in rows_in(folder / "m.csv")]


def test_emps_as_published(shell: Shell, real_logs: Path, tmp_path: Path) -> None:
    """Published offline: 95.1089 kg, and an error of 4.08 %."""
    said = identified("emps", f"{real_logs}/emps/emps_train.csv", shell)
    assert "good: 3 of 4 parameters known" in said  # and the offset, as friction is asymmetric
    assert estimates_in(tmp_path)["M"] == pytest.approx(95.1089, rel=0.001)
    (row,) = rows_in(tmp_path / "m.csv")
    assert float(row["relative_error"]) <= 4.2


PUBLISHED_R2 = [0.998, 0.997, 0.994, 0.995, 0.989, 0.992]


def test_six_axes_as_published(six_axes: Path, shell: Shell, tmp_path: Path) -> None:
    """At least 55 of 60 parameters within two published deviations."""
    identified("tx40.toml", f"{six_axes}/tx40_joint_5kHz.parquet", shell)
    assert len(far_from_published((tmp_path / "p.csv").read_text("utf-8"), six_axes)) <= 5
    r2 = r2_of(tmp_path)
    assert all(x >= known - 0.003 for x, known in zip(r2, PUBLISHED_R2, strict=True))


def test_a_vertical_arm_as_with_other_tools(shell: Shell, real_logs: Path, tmp_path: Path) -> None:
    """Three logs, one after the other, each with the bandwidth that it asks for.

    Compared with what was made by hand with other tools, on a fourth log at 5 Hz.
    """
    made = " && ".join(
        f"scarid resample -q --rate 500 {real_logs}/double_pendulum/20230629-{run}.csv -o {run}.csv"
        for run in (*TRAIN, "154548")
    )
    identify = "scarid identify -q --robot planar2-gravity --estimator wls"
    result = shell(
        f"{made} && {one_after_the_other(identify)} &&"
        " scarid differentiate --method zero-phase --set cutoff=5 154548.csv --format arrow |"
        " tee motion.arrows |"
        " scarid validate -q --robot planar2-gravity --all-rows --parameters p.csv -o m.csv"
    )
    assert result.status == 0, result.err
    inertias = [estimates_in(tmp_path)[name] for name in ("ZZ1R", "ZZ2", "MX1R", "MX2")]
    assert inertias == pytest.approx([0.0504, 0.0468, 0.1987, 0.1459], rel=0.05)
    one, two = r2_of(tmp_path)
    assert one >= 0.86
    assert two >= 0.96


def test_identify_reports_the_r2_of_a_bag_that_validate_finds(
    shell: Shell, real_logs: Path, tmp_path: Path
) -> None:
    """A bag of ROS 2: R2 of at least .985 for all joints, and validate says the same."""
    bag = real_logs / "ur10_ros2" / "ur10_exciting_trajectory.db3"
    urdf = (real_logs / "urdf" / "ur10.urdf").resolve()
    pytest.importorskip("pinocchio")
    body = load(str(urdf)).body
    assert body
    ur10_log(bag, body.joint_names, tmp_path / "bag.csv")
    assert shell("scarid resample -q --rate 125 bag.csv -o log.csv").status == 0
    said = identified(str(urdf), "log.csv", shell)
    found = re.search(r"R2 joints 1 to \d+ ((?:[\d.]+, )*[\d.]+)", said)
    assert found
    reported = [float(x) for x in found[1].split(", ")]
    r2 = r2_of(tmp_path)
    assert min(r2) >= 0.985
    assert r2 == pytest.approx(reported, abs=5e-4)  # at the ends rows have no torque when shifted
