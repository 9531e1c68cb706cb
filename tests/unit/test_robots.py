"""Descriptions of robots: what they say, and what is refused in them."""

from __future__ import annotations

import re
from math import inf
from pathlib import Path

import pytest

from scarid_cli.algorithms.robots.reading import ROBOTS, load
from scarid_cli.errors import UsageFault


def test_a_priori_values_are_those_of_table_2() -> None:
    robot = load("scara2")
    table = {
        "ZZ1R": 3.42,
        "Fv1": 0.07,
        "Fs1": 0.58,
        "ZZ2": 0.064,
        "L1MX2": 0.131,
        "L1MY2": 0.0,
        "Fv2": 0.015,
        "Fs2": 0.156,
    }
    assert dict(zip(robot.names, robot.apriori, strict=True)) == table
    assert robot.names == list(table)


def test_emps_values_are_the_published_ones() -> None:
    """Janot, Gautier, Brunot 2019."""
    robot = load("emps")
    published = {"M": 95.1089, "Fv": 203.5034, "Fc": 20.3935, "offset": -3.1648}
    assert dict(zip(robot.names, robot.apriori, strict=True)) == published


def test_value_is_found_by_term_and_joint() -> None:
    robot = load("scara2")
    assert robot.value("coulomb", 2) == 0.156
    assert robot.value("offset", 1) == 0.0


def test_unit_follows_the_type_of_joint() -> None:
    revolute, prismatic = load("scara2").joints[0], load("emps").joints[0]
    assert (revolute.unit, revolute.torque_unit) == ("rad", "N m")
    assert (prismatic.unit, prismatic.torque_unit) == ("m", "N")
    assert revolute.torque_limit == inf


def test_file_describes_a_robot_as_a_built_in_does(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text((ROBOTS / "emps.toml").read_text("utf-8"), "utf-8")
    mine, theirs = load(str(path)), load("emps")
    assert mine.name == str(path)
    assert (mine.title, mine.joints, mine.parameters, mine.control) == (
        theirs.title,
        theirs.joints,
        theirs.parameters,
        theirs.control,
    )


@pytest.mark.parametrize("name", ["scara3", "../robots/scara2.tml"])
def test_unknown_robot_is_refused_with_the_choice(name: str) -> None:
    with pytest.raises(UsageFault, match=r"unknown robot .*choose emps, planar2-gravity, scara2"):
        load(name)


def test_a_robot_without_a_title_has_that_of_its_file(tmp_path: Path) -> None:
    text = (ROBOTS / "emps.toml").read_text("utf-8")
    path = tmp_path / "linear axis.toml"
    path.write_text(text.replace('title = "EMPS, one prismatic axis"', ""), "utf-8")
    assert load(str(path)).title == "linear axis"


def test_a_description_that_is_not_there_is_refused() -> None:
    with pytest.raises(UsageFault, match=r"^nowhere/robot\.toml: no such file$"):
        load("nowhere/robot.toml")


@pytest.mark.parametrize(
    ("text", "instead", "complaint"),
    [
        ('title = "EMPS, one prismatic axis"', "title = 3", "title is 3, not a string"),
        ('title = "EMPS, one prismatic axis"', 'title = ""', "title is '', not a string"),
        ("[[joint]]", "[[axis]]", "axis is not a key of a robot; its keys are title, joint"),
        ("apriori = 95.1089", "", "apriori"),
        ("apriori = 95.1089", 'apriori = "heavy"', "apriori"),
        ("kp = [1370725.0]", "", "missing 'kp'"),
        ("kp = [1370725.0]", "kp = [1.0, 2.0]", "kp has 2 values for 1 joints"),
        ("position_limit", "position_bound", "position_bound"),
        ('"prismatic"', '"spherical"', "'spherical'; choose revolute or prismatic"),
        ('"viscous"', '"turbulent"', "'turbulent'; choose viscous, coulomb"),
        ("joint = 1", "joint = 2", "on joint 2 of a robot with 1"),
        ("joint = 1", "joint = -1", "on joint -1 of a robot with 1"),
        ("joint = 1", "", "joint"),
        ("joint = 1", 'joint = "1"', "not a whole number"),
        ("[control]", "[control", "at line"),
        ("prismatic axis", "prismatic axis\xe9", "utf-8"),
        ("joint = 1", "joint = 1\nvelocity = 0.1", "velocity is not a key of a [[parameter]] with"),
        ('"coulomb"', '"coulomb"\nvelocity = -0.1', "Fc: velocity is negative"),
        ('"coulomb"', '"stribeck"', "missing 'velocity'"),
        ('"coulomb"', '"stribeck"\nvelocity = 0', "Fc: velocity is not positive"),
        ('"coulomb"', '"coupled-coulomb"', "'coupled-coulomb'; choose viscous, coulomb"),
    ],
)
def test_bad_description_is_refused_in_one_line(
    tmp_path: Path, text: str, instead: str, complaint: str
) -> None:
    good = (ROBOTS / "emps.toml").read_text("utf-8")
    assert text in good
    path = tmp_path / "mine.toml"
    path.write_text(good.replace(text, instead), "latin-1")
    with pytest.raises(UsageFault) as refused:
        load(str(path))
    message = str(refused.value)
    assert re.match(rf"{re.escape(str(path))}(, line \d+)?: ", message)
    assert complaint in message
    assert "\n" not in message


def test_term_of_the_planar_arm_needs_two_joints(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text((ROBOTS / "emps.toml").read_text("utf-8").replace('"mass"', '"ZZ2"'), "utf-8")
    with pytest.raises(UsageFault, match="ZZ2"):
        load(str(path))


@pytest.mark.parametrize(
    ("text", "instead"),
    [
        ("kp = [1370725.0]", 'kp = "5"'),
        ("kp = [1370725.0]", 'kp = ["5"]'),
        ("kp = [1370725.0]", "kp = [[1.0]]"),
        ("velocity_cutoff = 200.0", 'velocity_cutoff = "x"'),
        ("joint = 1", "joint = 1.0"),
        ("apriori = 95.1089", "apriori = 1" + 400 * "0"),
        ("apriori = 95.1089", 'apriori = 95.1089\n"a\\nb" = 1'),
    ],
)
def test_description_that_cannot_be_used_is_refused_at_once(
    tmp_path: Path, text: str, instead: str
) -> None:
    path = tmp_path / "mine.toml"
    good = (ROBOTS / "emps.toml").read_text("utf-8")
    assert text in good
    path.write_text(good.replace(text, instead), "utf-8")
    with pytest.raises(UsageFault) as refused:
        load(str(path))
    assert str(path) in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("joint", ["joint = []", 'joint = [{type = "revolute"}]'])
def test_robot_without_parameters_is_refused(tmp_path: Path, joint: str) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(f'title = "none"\nparameter = []\n{joint}\n', "utf-8")
    with pytest.raises(UsageFault, match=r"mine\.toml"):
        load(str(path))


def test_term_given_twice_is_refused(tmp_path: Path) -> None:
    """The regressor would add both, and the plant take one."""
    path = tmp_path / "mine.toml"
    good = (ROBOTS / "emps.toml").read_text("utf-8")
    path.write_text(good.replace('"coulomb"', '"viscous"'), "utf-8")
    with pytest.raises(UsageFault, match="appears twice"):
        load(str(path))


@pytest.mark.parametrize(
    ("text", "advice"),
    [
        ("<mujoco model='arm'>", "a model of MuJoCo; make it a URDF first"),
        ("<?xml version='1.0'?>\n<sdf version='1.9'>", "an SDF model; give the URDF"),
        ("<?xml version='1.0'?>\n<robot name='arm'>", "let its name end in .urdf"),
        ("<notes/>", "unknown robot .*or a .toml or .urdf file"),
    ],
)
def test_a_model_of_another_program_is_told_for_what_it_is(
    text: str, advice: str, tmp_path: Path
) -> None:
    (tmp_path / "arm.xml").write_text(text)
    with pytest.raises(UsageFault, match=advice):
        load(str(tmp_path / "arm.xml"))
