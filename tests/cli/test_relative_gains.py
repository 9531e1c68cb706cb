"""What one log tells about torque constants: how the torques of the joints fit together."""

from __future__ import annotations

import re
from pathlib import Path

import pyarrow.parquet as pq
import pytest
from conftest import Shell

from scarid_cli.io.table import METADATA_KEY, Metadata

TRUE = {"ZZ1R": 3.42, "ZZ2": 0.0639, "L1MX2": 0.1312}  # of scara2
MADE = (
    "scarid trajgen -q --robot {robot} --seed {seed} {limits} --duration 20 |"
    " scarid simulate -q --robot {robot} --seed {seed} --format csv | cut -d, -f-{last}"
)
LIMITS = {  # and the last column of the log
    "planar2-gravity": ("--q-max 2,2 --ddq-max 20,30", 5),
    "three.urdf": ("--ddq-max 20,20,20", 7),
}
FACTOR = "awk -F, -v OFS=, 'NR > 1 {{ ${column} *= {factor} }} 1'"


def log(shell: Shell, robot: str, seed: int, column: int, factor: float) -> None:
    limits, last = LIMITS.get(robot, ("", 5))
    made = MADE.format(robot=robot, seed=seed, limits=limits, last=last)
    done = shell(f"{made} | {FACTOR.format(column=column, factor=factor)} > log.csv")
    assert done.status == 0, done.err


@pytest.mark.parametrize("factor", [0.7, 1.3558])
@pytest.mark.parametrize(("robot", "seed"), [("scara2", 2), ("planar2-gravity", 3)])
def test_a_torque_in_another_unit_is_named_and_allowed_for(
    robot: str, seed: int, factor: float, shell: Shell, tmp_path: Path
) -> None:
    """The torque of joint 2; only the ratio of both can be told."""
    log(shell, robot, seed, 5, factor)
    found = shell(f"scarid identify --robot {robot} log.csv -o p.parquet")
    told = re.search(r"doubtful: .*that of joint (\d) is (\S+) \+- (\S+) times", found.err)
    assert told, found.err
    true = factor if told[1] == "2" else 1.0 / factor
    assert float(told[2]) == pytest.approx(true, abs=2.0 * float(told[3]))
    assert float(told[3]) < 0.06 * true
    meta = Metadata.from_json(pq.read_schema(tmp_path / "p.parquet").metadata[METADATA_KEY])
    stored, error = meta.extra["relative_gains"][told[1]]
    assert stored == pytest.approx(true, abs=4.0 * error)
    if robot == "scara2":
        rows = pq.read_table(tmp_path / "p.parquet").to_pylist()
        values = {row["parameter"]: row["estimate"] for row in rows}
        for name, value in TRUE.items():
            assert values[name] == pytest.approx(value, rel=0.02)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_right_log_is_good_and_says_nothing_of_gains(seed: int, shell: Shell) -> None:
    log(shell, "scara2", seed, 5, 1.0)
    found = shell("scarid identify --robot scara2 log.csv -o p.parquet")
    assert "scarid identify: good: " in found.err
    assert "do not fit together" not in found.err


def test_joints_without_a_common_parameter_have_no_gains(shell: Shell, tmp_path: Path) -> None:
    """As of a Cartesian robot: each joint has parameters of its own."""
    joint = '[[joint]]\ntype = "prismatic"\nposition_limit = 0.5\nvelocity_limit = 1.0\n'
    terms = "".join(
        f'[[parameter]]\nname = "{name}{j}"\nunit = "kg"\njoint = {j}\nterm = "{term}"\n'
        f"apriori = {value}\n"
        for j in (1, 2)
        for name, term, value in (
            ("M", "mass", 9.0),
            ("Fv", "viscous", 20.0),
            ("Fc", "coulomb", 5.0),
        )
    )
    (tmp_path / "gantry.toml").write_text(
        'title = "gantry"\n'
        + 2 * (joint + "acceleration_limit = 5.0\ntorque_noise = 0.1\n")
        + terms
    )
    done = shell(
        "scarid trajgen -q --robot gantry.toml --seed 1 --duration 20 |"
        " scarid simulate -q --robot gantry.toml --seed 1 |"
        " scarid identify --robot gantry.toml -o p.parquet"
    )
    assert done.status == 0, done.err
    assert "scarid identify: good: " in done.err
    meta = Metadata.from_json(pq.read_schema(tmp_path / "p.parquet").metadata[METADATA_KEY])
    assert "relative_gains" not in meta.extra


def test_changes_are_seen_beside_a_gain_that_was_fitted(shell: Shell) -> None:
    """The torque of joint 2 in another unit in all logs, and in the last one 5 % more of it."""
    log(shell, "scara2", 2, 5, 0.7)
    assert shell("scarid identify -q --robot scara2 log.csv -o p.parquet").status == 0
    validate = "scarid validate --robot scara2 --parameters p.parquet log.csv -o m.parquet"
    log(shell, "scara2", 5, 5, 0.7)
    assert "scarid validate: unchanged: " in shell(validate).err
    log(shell, "scara2", 5, 5, 0.735)
    found = shell(validate)
    told = re.search(r"changed: motor constant of joint 2 \(torques (\S+) \+- (\S+) %\)", found.err)
    assert told, found.err
    assert float(told[1]) == pytest.approx(5.0, abs=2.0 * float(told[2]))


@pytest.mark.parametrize("joint", [1, 2])
def test_the_joint_that_is_apart_is_named_and_not_all_others(
    joint: int, shell: Shell, tmp_path: Path
) -> None:
    """Of three: gains are relative to the joints that agree, whichever has the largest torque."""
    links = "".join(
        f'<link name="l{j}"><inertial><origin xyz="0.15 0 0"/><mass value="{4 - j}"/><inertia'
        ' ixx="0.01" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.03"/></inertial></link>'
        for j in (1, 2, 3)
    )
    joints = "".join(
        f'<joint name="j{j}" type="revolute"><parent link="l{j - 1}"/><child link="l{j}"/>'
        f'<origin xyz="{0.3 * (j > 1)} 0 0"/><axis xyz="0 1 0"/>'
        '<limit lower="-2" upper="2" effort="80" velocity="4"/></joint>'
        for j in (1, 2, 3)
    )
    arm = f'<robot name="three"><link name="l0"/>{links}{joints}</robot>'
    (tmp_path / "three.urdf").write_text(arm)
    log(shell, "three.urdf", 1, 4 + joint, 1.3)
    found = shell("scarid identify --robot three.urdf log.csv -o p.parquet")
    told = re.findall(r"that of joint (\d) is (\S+) \+- (\S+) times", found.err)
    assert [of for of, _, _ in told] == [str(joint)], found.err
    (_, factor, error), *_ = told
    assert float(factor) == pytest.approx(1.3, abs=2.0 * float(error))
    rows = {row["parameter"]: row for row in pq.read_table(tmp_path / "p.parquet").to_pylist()}
    mass = rows["Iyy3"]
    assert mass["low"] < 0.03 + 0.15**2 < mass["high"]
