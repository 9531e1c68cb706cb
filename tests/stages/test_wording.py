"""The columns of logs whose names say in words what they hold."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scarid_cli.stages.conversion.recorders import Recognised
from scarid_cli.stages.conversion.wording import Unclear, in_short, in_words, renamable

# Headers as recorders, robots' tools and people write them, with the columns that become
# t, q1, ..., and tau1, ..., in this order.
HEADERS = {
    "ros2_control, in text": (
        "t arm_1_joint_position arm_2_joint_position arm_1_joint_effort arm_2_joint_effort",
        "arm_1_joint_position arm_2_joint_position arm_1_joint_effort arm_2_joint_effort",
    ),
    "rostopic echo -p": (
        "time field.header.seq field.header.stamp field.name0 field.position0 field.position1"
        " field.velocity0 field.velocity1 field.effort0 field.effort1",
        "field.header.stamp field.position0 field.position1 field.effort0 field.effort1",
    ),
    "counted from 0": ("time q_0 q_1 tau_0 tau_1", "time q_0 q_1 tau_0 tau_1"),
    "counted from 0, beside our names": ("t q0 q1 tau0 tau1", "q0 q1 tau0 tau1"),
    "capitals": ("Time Q1 Q2 Tau1 Tau2", "Time Q1 Q2 Tau1 Tau2"),
    "joint before quantity": (
        "timestamp joint1_pos joint2_pos joint1_vel joint1_torque joint2_torque",
        "timestamp joint1_pos joint2_pos joint1_torque joint2_torque",
    ),
    "camel case": (
        "Time jointPosition1 jointPosition2 jointTorque1 jointTorque2",
        "Time jointPosition1 jointPosition2 jointTorque1 jointTorque2",
    ),
    "units": (
        "t_ms angle_1_deg angle_2_deg torque_1_Nm torque_2_Nm",
        "t_ms angle_1_deg angle_2_deg torque_1_Nm torque_2_Nm",
    ),
    "references, estimates, the tool": (
        "time q_1 q_2 q_d_1 q_d_2 position_x position_y tau_J_1 tau_J_2 tau_ext_1 tau_ext_2"
        " ddq_1 ddq_2",
        "time q_1 q_2 tau_J_1 tau_J_2",
    ),
    "a gripper without effort": (
        "t position_1 position_2 position_3 effort_1 effort_2",
        "position_1 position_2 effort_1 effort_2",
    ),
    "columns not in order": (
        "t pos_2 pos_10 pos_1 pos_3 pos_4 pos_5 pos_6 pos_7 pos_8 pos_9",
        " ".join(f"pos_{i}" for i in range(1, 11)),
    ),
    "forces and torques": (
        "t rail_pos_mm a1_pos_deg rail_force_N a1_torque_Nm",
        "rail_pos_mm a1_pos_deg rail_force_N a1_torque_Nm",
    ),
    "what is measured beside what is not said to be": (
        "time q_1 q_2 tau_1 tau_2 tau_measured_1 tau_measured_2",
        "time q_1 q_2 tau_measured_1 tau_measured_2",
    ),
    "a short clock": ("ts pos_1 pos_2 trq_1 trq_2", "ts pos_1 pos_2 trq_1 trq_2"),
    "one joint": ("time position torque", "time position torque"),
    "torques only": ("t q1 q2 effort_1 effort_2", "effort_1 effort_2"),
    "a simulator's generalized forces": (
        "time qpos0 qpos1 qvel0 qvel1 qfrc_actuator0 qfrc_actuator1 qfrc_bias0 qfrc_passive0",
        "time qpos0 qpos1 qfrc_actuator0 qfrc_actuator1",
    ),
    "a simulator's clock": (
        "sim_time joint_pos_0 joint_pos_1 applied_torque_0 applied_torque_1",
        "sim_time joint_pos_0 joint_pos_1 applied_torque_0 applied_torque_1",
    ),
    "units alone": ("time J1_deg J2_deg J1_Nm J2_Nm", "time J1_deg J2_deg J1_Nm J2_Nm"),
    "clocks within structures": (
        "out.tout out.q.time out.q.signals.values1 out.tau.time out.tau.signals.values1",
        "out.tout out.q.signals.values1 out.tau.signals.values1",
    ),
    "motors as well": (
        "t joint_position_1 motor_position_1 joint_torque_1 motor_torque_1",
        "joint_position_1 joint_torque_1",
    ),
}


def renamed(header: str, *joints: str) -> dict[str, str]:
    found = in_words(header.split(), (), joints)
    return found.columns if found else {}


@pytest.mark.parametrize("kind", HEADERS)
def test_columns_are_known_by_the_words_in_their_names(kind: str) -> None:
    header, expected = HEADERS[kind]
    columns = renamed(header)
    joints = sum(new.startswith("q") for new in columns) or 2
    order = ["t", *(f"{x}{i + 1}" for x in ("q", "tau") for i in range(joints))]
    assert [columns[new] for new in order if new in columns] == expected.split()
    assert {*columns} <= {*order, *(f"dq{i + 1}_measured" for i in range(joints))}


def test_velocities_are_kept_as_measured_ones_beside_positions_of_other_names() -> None:
    columns = renamed("time pos1 vel1 torque1")
    assert columns["dq1_measured"] == "vel1"
    assert "dq1_measured" not in renamed("time q1 vel1 torque1")


def test_currents_are_torques_only_where_there_are_no_others() -> None:
    assert renamed("t position_1 current_1") == {"q1": "position_1", "current1": "current_1"}
    assert "current1" not in renamed("t position_1 current_1 torque_1")
    assert renamed("t current_position_1 effort_1") == {
        "q1": "current_position_1",
        "tau1": "effort_1",
    }


def test_joints_with_names_are_in_the_order_of_the_robot() -> None:
    header = "t elbow_joint_position shoulder_pan_joint_position gripper_position"
    assert list(renamed(header).values()) == header.split()[1:]
    order = ("shoulder_pan_joint", "elbow_joint")
    assert renamed(header, *order) == {
        "q1": "shoulder_pan_joint_position",
        "q2": "elbow_joint_position",
    }


@pytest.mark.parametrize(
    ("header", "joints", "why"),
    [
        ("t position_1 pos_1 torque_1", (), "both position_1 and pos_1 could be q of one joint"),
        ("t position_2 position_3", (), "their joints are numbered 2, 3"),
        ("t position_1 position_3", (), "their joints are numbered 1, 3"),
        ("t a1.pos[inc] a1.torque[0.1%]", (), r"a1.pos\[inc\] does not say what one inc is"),
        ("t pos1(deg) trq1(%)", (), r"trq1\(%\) does not say what one % is"),
        ("t left_position right_torque", (), "seem to be of different joints"),
        ("t left_position right_position", ("shoulder", "elbow"), "none of the joints shoulder"),
        (
            "t rail_pos a_pos b_pos a_tau b_tau",
            ("rail", "a", "b"),
            "there is a_tau, b_tau, but none of rail",
        ),
        (
            "t pos_0 pos_1 pos_2 tau_0 tau_1 tau_2",
            ("joint1", "joint2"),
            r"from 0, and those of the robot from 1 to 2 \(--joints 0,1 takes the first ones\)",
        ),
    ],
)
def test_what_is_unclear_is_not_guessed(header: str, joints: tuple[str, ...], why: str) -> None:
    with pytest.raises(Unclear, match=why):
        in_words(header.split(), (), joints)


@pytest.mark.parametrize(
    "header",
    [
        "t q1 q2 dq1 dq2 ddq1 ddq2 tau1 tau2",  # ours
        "t q1_ref dq1_ref ddq1_ref",
        "stamp mode volt",
        "parameter estimate unit",
        "t Fv1 Fs1",
        "t motor_position_1 motor_torque_1",  # behind a gear
    ],
)
def test_other_tables_keep_their_names(header: str) -> None:
    assert renamed(header) == {}
    assert not renamable(header.split())


def test_a_clock_in_ticks_of_its_device_is_left_to_the_user() -> None:
    assert renamed("time[ticks] pos1 torque1") == {"q1": "pos1", "tau1": "torque1"}


def test_names_that_are_given_are_not_looked_for() -> None:
    found = in_words(["time", "encoder", "torque_1"], {"q1"}, ())
    assert found is not None
    assert found.columns == {"t": "time", "tau1": "torque_1"}


def test_positions_of_what_has_no_torque_are_told() -> None:
    found = in_words(["t", "pos_1", "pos_2", "gripper_pos", "tau_1", "tau_2"], (), ())
    assert found is not None
    assert found.left_out == ("gripper_pos",)


def test_many_columns_are_told_in_short() -> None:
    found = in_words(["time_ms", "pos_0", "pos_1", "pos_2", "left_torque"], {"tau1"}, ())
    assert found is not None
    assert in_short(found) == "t from time_ms (ms); q1 to q3 from pos_0 to pos_2"


@given(
    joints=st.integers(1, 12),
    first=st.sampled_from([0, 1]),
    forms=st.tuples(
        *(st.sampled_from(["{}_{{}}", "joint{{}}_{}", "{}[{{}}]", "/state/{}{{}}"]),) * 2
    ),
    words=st.tuples(st.sampled_from(["position", "Pos", "q"]), st.sampled_from(["effort", "Tau"])),
    named=st.sampled_from([None, 0, 1]),
    order=st.randoms(use_true_random=False),
)
def test_numbered_joints_keep_their_order_however_the_columns_lie(
    joints: int,
    first: int,
    forms: tuple[str, str],
    words: tuple[str, str],
    named: int | None,
    order: object,
) -> None:
    """Whether the robot's joints have no names, or are counted from 0 or 1."""
    numbers = range(first, first + joints)
    own = [[f.format(w).format(k) for k in numbers] for f, w in zip(forms, words, strict=True)]
    columns = ["time", *own[0], *own[1]]
    order.shuffle(columns)  # type: ignore[attr-defined]
    robot = [] if named is None else [f"arm_joint{named + k}" for k in range(joints)]
    found = in_words(columns, (), robot)
    assert isinstance(found, Recognised)
    for name, expected in zip(("q", "tau"), own, strict=True):
        assert [found.columns[f"{name}{i}"] for i in range(1, joints + 1)] == expected


def test_a_log_that_counts_from_0_is_not_taken_for_one_of_ours() -> None:
    assert renamable(["t", "q0", "q1", "q2", "tau0", "tau1", "tau2"])
    assert not renamable(["t", "q1", "q2", "tau1", "tau2"])
