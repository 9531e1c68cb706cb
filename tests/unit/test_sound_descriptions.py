"""Descriptions that are no robot are refused in a moment, and name what is wrong."""

from __future__ import annotations

import os
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pinocchio
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scarid_cli.algorithms.robots import reading
from scarid_cli.algorithms.robots.files import LARGEST
from scarid_cli.algorithms.robots.loops import without_loops
from scarid_cli.algorithms.robots.sound import JOINTS, require_tree, without_impossible
from scarid_cli.errors import UsageFault


def urdf(parents: list[int], origin: str = "0 0 1") -> str:
    """A URDF whose link k hangs on link parents[k - 1]; link 0 is the base."""
    links = "".join(f'<link name="l{k}"/>' for k in range(len(parents) + 1))
    joints = "".join(
        f'<joint name="j{k}" type="revolute"><parent link="l{parent}"/><child link="l{k}"/>'
        f'<origin xyz="{origin}"/><axis xyz="0 1 0"/>'
        '<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>'
        for k, parent in enumerate(parents, start=1)
    )
    return f'<robot name="r">{links}{joints}</robot>'


@st.composite
def hanging(draw: st.DrawFn) -> list[int]:
    """Where each link hangs: anywhere, also on itself or on a later one."""
    count = draw(st.integers(1, 8))
    return [draw(st.integers(0, count)) for _ in range(count)]


@given(hanging())
def test_a_tree_is_accepted_and_a_cycle_is_not(parents: list[int]) -> None:
    """By the other definition: from every link the base is reached."""

    def reaches(link: int) -> bool:
        for _ in parents:
            link = parents[link - 1] if link else 0
        return link == 0

    tree = ElementTree.fromstring(urdf(parents))
    if all(map(reaches, range(len(parents) + 1))):
        require_tree(tree)
    else:
        with pytest.raises(ValueError, match="no way leads from the base l0 to joint"):
            require_tree(tree)


def closed(text: str, parent: int, child: int) -> str:
    """A URDF with one joint more, `more`, that carries a link that another one carries."""
    joint = (
        f'<joint name="more" type="revolute"><parent link="l{parent}"/><child link="l{child}"/>'
        '<axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>'
    )
    return text.replace("</robot>", f"{joint}</robot>")


@given(st.integers(1, 8).flatmap(lambda n: st.tuples(*(st.integers(0, k) for k in range(n)))),
       st.integers(0, 8), st.integers(1, 8))  # fmt: skip
def test_of_a_closed_chain_the_tree_is_left(parents: list[int], one: int, other: int) -> None:
    """Whether what closes it comes from above or from below, or even from the link itself."""
    count = len(parents)
    tree = ElementTree.fromstring(closed(urdf(list(parents)), one % (count + 1), other % count + 1))
    (told,) = without_loops(tree)
    require_tree(tree)
    assert told.startswith("joint more: left out, as joint j")
    assert [joint.get("name") for joint in tree.findall("joint")] == [
        f"j{k}" for k in range(1, count + 1)
    ]


def test_of_a_closed_chain_the_axes_that_are_named_are_kept() -> None:
    tree = ElementTree.fromstring(closed(urdf([0, 1, 0]), 3, 2))
    (told,) = without_loops(tree, ("j1", "more"))
    assert told.startswith("joint j2: left out, as joint more carries link l2 as well")


def test_a_closed_chain_is_told_by_the_commands_that_read_the_robot(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    loop = '<loop_joint name="rod" type="fixed"><link1 link="l2"/><link2 link="l3"/></loop_joint>'
    path.write_text(closed(urdf([0, 1, 0]), 3, 2).replace("</robot>", f"{loop}</robot>"))
    body = reading.load(str(path)).body
    assert body
    assert [doubt.split(":")[0] for doubt in body.doubts] == ["loop_joint rod", "joint more"]


@pytest.mark.parametrize("origin", ["0 0 1e100", "nan 0 0", "0 -inf 0", "1e7 0 0"])
def test_origins_out_of_this_world_are_refused(origin: str, tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(urdf([0, 1], origin))
    with pytest.raises(UsageFault, match="the origin of joint j1 has xyz"):
        reading.load(str(path))


def test_a_long_chain_is_refused_before_its_parser_recurses(tmp_path: Path) -> None:
    path = tmp_path / "chain.urdf"
    path.write_text(urdf(list(range(5 * JOINTS))))
    with pytest.raises(UsageFault, match=f"more than {JOINTS}"):
        reading.load(str(path))


def test_an_element_with_very_many_attributes_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "many.urdf"
    many = " ".join(f'a{k}="1"' for k in range(40_000))
    path.write_text(urdf([0]).replace('<robot name="r">', f'<robot name="r" {many}>'))
    with pytest.raises(UsageFault, match="40001 attributes"):
        reading.load(str(path))


@pytest.mark.parametrize("key", ["a.a", '"b".c', "a . b"])
def test_a_key_of_very_many_parts_is_refused(key: str, tmp_path: Path) -> None:
    path = tmp_path / "bomb.toml"
    path.write_text("title = 'x'\n" + ".".join([key] * 6000) + " = 1\n")
    with pytest.raises(UsageFault, match="line 2: a key of more than"):
        reading.load(str(path))


def test_numbers_with_points_are_no_key(tmp_path: Path) -> None:
    path = tmp_path / "arm.toml"
    path.write_text("joint = [" + ", ".join(["0.5"] * 500) + "]\n")
    with pytest.raises(UsageFault) as refused:
        reading.load(str(path))
    assert "parts" not in str(refused.value)


def test_only_files_of_some_size_are_read(tmp_path: Path) -> None:
    robot = tmp_path / "robot.toml"
    for other in ("/dev/zero", str(tmp_path / "pipe"), str(tmp_path)):
        if other.endswith("pipe"):
            os.mkfifo(other)
        robot.write_text(f'urdf = "{other}"\n')
        with pytest.raises(UsageFault, match="not a regular file"):
            reading.load(str(robot))
    huge = tmp_path / "huge.urdf"
    with huge.open("wb") as file:
        file.truncate(LARGEST + 1)
    with pytest.raises(UsageFault, match="MB are no description"):
        reading.load(str(huge))


def with_inertia(mass: str, moments: tuple[float, float, float]) -> str:
    """A URDF of two links, of which the second has this mass and these moments of inertia."""
    inertia = " ".join(f'i{a}="{m!r}"' for a, m in zip(("xx", "yy", "zz"), moments, strict=True))
    inertial = f'<inertial><mass value="{mass}"/><inertia {inertia} ixy="0" ixz="0" iyz="0"/>'
    return urdf([0, 1]).replace(
        '<link name="l2"/>', f'<link name="l2">{inertial}</inertial></link>'
    )


MOMENTS = st.floats(-1.0, 1.0).filter(lambda moment: abs(moment) > 1e-6)


@given(st.tuples(MOMENTS, MOMENTS, MOMENTS))
def test_an_inertia_is_told_exactly_if_no_body_has_it(moments: tuple[float, float, float]) -> None:
    """By the second moments of a mass: each is half the sum of two inertias less the third."""
    tree = ElementTree.fromstring(with_inertia("1", moments))
    told = without_impossible(tree)
    seconds = [sum(moments) / 2.0 - moment for moment in moments]
    if min(seconds) >= 0.0:
        assert not told
    elif min(seconds) < -0.01 * max(map(abs, moments)):
        (text,) = told
        assert text.startswith("link l2: its principal inertias are ")


@pytest.mark.parametrize("moments", [(-2.4e-35, 0.0, 2.4e-35), (4.9e-21, 3.6e-20, 5.5e-20)])
def test_what_rounding_leaves_of_the_inertia_of_a_point_is_not_told(
    moments: tuple[float, float, float],
) -> None:
    tree = ElementTree.fromstring(with_inertia("1", moments))
    assert not without_impossible(tree)
    inertia = tree.find(".//inertia")
    assert inertia is not None
    assert min(float(inertia.get(key, "0")) for key in ("ixx", "iyy", "izz")) >= 0.0


@given(st.floats(-1e100, -1e-9))
def test_a_negative_mass_is_told_and_taken_as_none(mass: float) -> None:
    tree = ElementTree.fromstring(with_inertia(repr(mass), (0.1, 0.1, 0.1)))
    (text,) = without_impossible(tree)
    assert text == f"link l2: its mass is {mass!r} kg; taken as without mass"
    assert tree.find(".//inertial") is None


@pytest.mark.parametrize("free", ["floating", "planar"])
def test_a_free_base_is_fixed_where_the_axes_are_named(tmp_path: Path, free: str) -> None:
    base = urdf([0, 1, 2]).replace('name="j1" type="revolute"', f'name="j1" type="{free}"')
    fixed = urdf([0, 1, 2]).replace('name="j1" type="revolute"', 'name="j1" type="fixed"')
    for name, text in (("free", base), ("fixed", fixed)):
        (tmp_path / f"{name}.urdf").write_text(text)
        joints = 'title = "arm"\n[[joint]]\nname = "j2"\n[[joint]]\nname = "j3"\n'
        (tmp_path / f"{name}.toml").write_text(f'urdf = "{name}.urdf"\n{joints}')
    robot = reading.load(str(tmp_path / "free.toml"))
    same = reading.load(str(tmp_path / "fixed.toml"))
    assert robot.body is not None
    assert robot.body.doubts == [
        "joint j1: taken as fixed, as it is none of the axes that are named"
    ]
    assert robot.names == same.names
    with pytest.raises(UsageFault, match=r"and j1 is neither; name the axes"):
        reading.load(str(tmp_path / "free.urdf"))


def test_a_joint_that_is_no_axis_is_locked_where_the_posture_has_it(tmp_path: Path) -> None:
    """Against Pinocchio's model of all joints."""
    text = urdf([0, 1, 2])
    for link in ("l1", "l2", "l3"):
        inertia = '<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/>'
        inertial = f'<inertial><mass value="2"/>{inertia}</inertial>'
        text = text.replace(f'<link name="{link}"/>', f'<link name="{link}">{inertial}</link>')
    (tmp_path / "arm.urdf").write_text(text)
    axes = '[[joint]]\nname = "j1"\n[[joint]]\nname = "j3"\n'
    head = 'title = "arm"\nurdf = "arm.urdf"\n'
    (tmp_path / "arm.toml").write_text(f"{head}posture = {{ j2 = 0.7 }}\n{axes}")
    body = reading.load(str(tmp_path / "arm.toml")).body
    assert body is not None
    other = pinocchio.buildModelFromXML(text)
    data = other.createData()
    pinocchio.framesForwardKinematics(other, data, np.array([0.3, 0.7, -0.4]))
    found, _ = body.pose(np.array([[0.3], [-0.4]])).positions(body.points("l3"))
    wanted = data.oMf[other.getFrameId("l3")].translation
    np.testing.assert_allclose(found[0, 0], wanted, atol=1e-12)
    (tmp_path / "arm.toml").write_text(f"{head}posture = {{ j3 = 0.7 }}\n{axes}")
    with pytest.raises(UsageFault, match="joint of posture, which is no axis"):
        reading.load(str(tmp_path / "arm.toml"))
