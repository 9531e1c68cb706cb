"""Which joints of a URDF are axes, which are locked, and what becomes of the locked ones."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from unit.arms import FINGERS, URDF, described_arm

from scarid_cli.algorithms.robots.axes import serial
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.cli.robot import described
from scarid_cli.errors import UsageFault

pytest.importorskip("pinocchio")

BRANCHED = "beyond {}, where the joints branch and the arm ends"


@pytest.mark.parametrize(
    ("parents", "axes", "locked"),
    [
        ([0, 1, 2], "abc", {}),
        ([0, 1, 2, 2], "ab", {"c": BRANCHED.format("b"), "d": BRANCHED.format("b")}),
        ([0, 1, 1, 3, 4], "acde", {"b": "on a side branch of the arm"}),
        ([0, 1, 2, 1, 4], "a", dict.fromkeys("bcde", BRANCHED.format("a"))),
        ([0, 0], "", None),
    ],
    ids=["serial", "two fingers", "camera on a link", "two arms on a torso", "two arms"],
)
def test_the_arm_is_the_chain_that_outweighs_its_branches(
    parents: list[int], axes: str, locked: dict[str, str] | None
) -> None:
    chain = serial("abcde"[: len(parents)], parents, {})
    assert "".join(chain.axes) == axes
    if locked is not None:
        assert chain.locked == locked


@pytest.mark.parametrize(
    ("frames", "axes"),
    [({2}, "ab"), ({3}, "abc"), ({2, 3}, "abc"), ({1}, "abc"), (set(), "abc")],
)
def test_a_last_joint_beyond_the_tool_frame_is_a_jaw(frames: set[int], axes: str) -> None:
    chain = serial("abc", [0, 1, 2], {}, frames)
    assert "".join(chain.axes) == axes
    locked = {} if axes == "abc" else {"c": "beyond b, whose link carries the tool frame"}
    assert chain.locked == locked


LOST = "mimics b, an axis, but is modelled as locked"


@pytest.mark.parametrize(
    ("parents", "drivers", "followers", "locked"),
    [
        ([0, 1, 2], {"c": "b"}, {"c": "b"}, {}),
        ([0, 1, 2, 3], {"d": "c", "c": "b"}, {"c": "b", "d": "b"}, {}),
        ([0, 1, 2, 2], {"c": "b", "d": "b"}, {}, {"c": LOST, "d": LOST}),
        ([0, 1, 2, 2], {"d": "c"}, {}, {"c": BRANCHED.format("b"), "d": "mimics c"}),
    ],
    ids=["on the way", "in turn", "beside it", "of no axis"],
)
def test_a_joint_that_mimics_another_is_no_axis(
    parents: list[int], drivers: dict[str, str], followers: dict[str, str], locked: dict[str, str]
) -> None:
    chain = serial("abcd"[: len(parents)], parents, drivers)
    assert (chain.axes, chain.followers, chain.locked) == (("a", "b"), followers, locked)


# In a robot


@pytest.fixture
def gripper(tmp_path: Path) -> Path:
    """The arm of two links, with a hand of two fingers of 0.1 kg."""
    path = tmp_path / "gripper.urdf"
    path.write_text(URDF.replace("TYPE", "revolute").replace("</robot>", FINGERS + "</robot>"))
    return path


def test_fingers_are_locked_and_their_mass_is_carried(gripper: Path) -> None:
    robot = load(str(gripper))
    assert len(robot.joints) == 2
    assert robot.body is not None
    masses = robot.body.standard[9::10]
    assert masses == pytest.approx([2.0, 1.0 + 0.1 + 0.1])
    # The left finger is at 0, the right one at its offset of 0.02 m along y.
    assert robot.body.standard[17] == pytest.approx(0.1 * 0.02)


def test_a_check_shows_which_joints_are_locked_and_why(gripper: Path) -> None:
    lines = list(described(load(str(gripper))))
    assert "freedom     2 joints, 13 parameters" in lines
    at = lines.index("  locked: left (beyond b, where the joints branch and the arm ends)")
    assert lines[at + 1] == "  locked: right (mimics left)"


def test_a_finger_that_is_named_is_an_axis(gripper: Path, tmp_path: Path) -> None:
    names = "".join(f"[[joint]]\nname = '{name}'\n" for name in ("a", "b", "left"))
    robot = described_arm(str(gripper), tmp_path, names)
    assert [joint.type for joint in robot.joints] == ["revolute", "revolute", "prismatic"]
    assert (robot.joints[2].lower, robot.joints[2].upper) == (0.0, 0.04)
    assert robot.body is not None
    assert robot.body.locked == {"right": "mimics left, an axis, but is modelled as locked"}


def test_entries_for_locked_joints_are_refused_with_their_names(
    gripper: Path, tmp_path: Path
) -> None:
    with pytest.raises(
        UsageFault, match=r"4 tables .* for the 2 axes of .*\(locked: left, right\)"
    ):
        described_arm(str(gripper), tmp_path, "[[joint]]\n" * 4)


def test_joints_that_branch_at_the_base_must_be_named(tmp_path: Path) -> None:
    path = tmp_path / "arms.urdf"
    path.write_text(URDF.replace("TYPE", "revolute").replace('"one"/><child', '"base"/><child'))
    with pytest.raises(UsageFault, match=r"branch at the base.*\[\[joint\]\] name = .*: a, b"):
        load(str(path))
    names = "[[joint]]\nname = 'a'\n[[joint]]\nname = 'b'"
    assert len(described_arm(str(path), tmp_path, names).joints) == 2


# Robots as they are published


@pytest.mark.parametrize(
    ("name", "axes", "locked"),
    [
        ("panda", 7, ["panda_finger_joint1", "panda_finger_joint2"]),
        ("so101", 5, ["gripper"]),
        ("ur10", 6, []),
        ("xarm7", 7, []),
    ],
)
def test_published_arms_have_their_axes(
    name: str, axes: int, locked: list[str], real_logs: Path
) -> None:
    robot = load(str(real_logs / "urdf" / f"{name}.urdf"))
    assert len(robot.joints) == axes
    assert robot.body is not None
    assert list(robot.body.locked) == locked


# Their limits


def limits_of(robot: Robot) -> list[tuple[float, float]]:
    return [(joint.lower, joint.upper) for joint in robot.joints]


def test_both_ends_of_a_position_limit_are_read(tmp_path: Path) -> None:
    path = tmp_path / "x.urdf"
    text = URDF.replace("TYPE", "revolute")
    path.write_text(text.replace('lower="-3" upper="3"', 'lower="-3.07" upper="-0.07"', 1))
    assert limits_of(load(str(path))) == [(-3.07, -0.07), (-3.0, 3.0)]
    lines = "[[joint]]\n[[joint]]\nposition_limit = [-0.5, 2]"
    assert limits_of(described_arm(str(path), tmp_path, lines)) == [(-3.07, -0.07), (-0.5, 2.0)]
    lines = "[[joint]]\nposition_limit = 1.5\n[[joint]]"
    assert limits_of(described_arm(str(path), tmp_path, lines)) == [(-1.5, 1.5), (-3.0, 3.0)]


def test_a_limit_that_the_urdf_does_not_give_is_infinite(tmp_path: Path) -> None:
    path = tmp_path / "x.urdf"
    path.write_text(URDF.replace("TYPE", "revolute").replace('lower="-3" upper="3" ', "", 1))
    assert limits_of(load(str(path))) == [(-np.inf, np.inf), (-3.0, 3.0)]


@pytest.mark.parametrize(
    ("value", "complaint"),
    [
        ("-1.0", "position_limit is negative"),
        ("[1.0, -1.0]", "position_limit [1.0, -1.0]: the lower end is above the upper one"),
        ("[1.0]", "position_limit is [1.0], not a list of 2 numbers"),
        ("['a', 1.0]", "position_limit is 'a', not a number"),
        ("'wide'", "position_limit is 'wide', not a number"),
    ],
)
def test_a_position_limit_that_is_no_interval_is_refused(
    value: str, complaint: str, gripper: Path, tmp_path: Path
) -> None:
    with pytest.raises(UsageFault) as refused:
        described_arm(str(gripper), tmp_path, f"[[joint]]\nposition_limit = {value}\n[[joint]]")
    assert complaint in str(refused.value)
