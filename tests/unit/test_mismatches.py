"""Late signals and joints that yield: their columns in closed form, and found in logs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from conditions import Condition, log, robot_named, truth_of
from conftest import seeds
from gauntlet import blind
from hypothesis import given, settings
from mechanics import CHANGES
from unit.pendulum import ARM, MODEL, SINES, H, motion
from unit.support import cuts
from unit.test_additions import diagnosed, nothing
from unit.test_additions import log as log_of

from scarid_cli.algorithms.beyond.additions import Addition, mean_additions
from scarid_cli.algorithms.beyond.catalogue import MISMATCHES
from scarid_cli.algorithms.beyond.gears import (
    Backlash,
    ElasticGear,
    ElasticJoint,
    Hysteresis,
    LatePosition,
    LateTorque,
    Presliding,
)
from scarid_cli.algorithms.effects.additions import Shapes
from scarid_cli.algorithms.inference.sentences import additions_of
from scarid_cli.algorithms.regression.rows import Rows, rows_of
from scarid_cli.arrays import Array
from scarid_cli.io.facts import CHECKS
from scarid_cli.stages.results.parameters import Identified
from scarid_cli.stages.results.prediction import of_parts

INSIDE = slice(200, -200)  # without the ends, where derivatives are one-sided
THETA = ARM.apriori


def at(time: Array) -> Array:
    """The motion (3, joints, samples) of `pendulum.motion` at other times (joints, samples)."""
    found = np.zeros((3, *time.shape))
    for joint, sines in enumerate(SINES):
        for size, frequency, phase in sines:
            w = 2.0 * np.pi * frequency
            angle = w * time[joint] + phase
            found[0, joint] += size * np.sin(angle)
            found[1, joint] += size * w * np.cos(angle)
            found[2, joint] -= size * w * w * np.sin(angle)
    return found


def torques(moved: Array) -> Array:
    return ARM.torques(ARM.regressor(*moved), THETA)


def rows(moved: Array, tau: Array | None = None) -> Rows:
    own = torques(moved) if tau is None else tau
    return rows_of(ARM, np.stack((*moved, own)), np.arange(moved.shape[2]), H)


def change(name: str, joint: int, size: float, seen: Rows) -> Array:
    """How the torques (joints, samples) change by a mismatch of this size."""
    shapes = Shapes([Addition(name, joint, 1.0, size)], MODEL, THETA)
    return shapes.torques(seen).T


def turning(moved: Array) -> Array:
    """Samples within 5 of a reversal of any joint, where friction jumps."""
    turns = np.any(np.diff(np.sign(moved[1]), axis=1) != 0, axis=0).astype(float)
    return np.convolve(np.append(turns, 0.0), np.ones(11), "same") > 0


def near(found: Array, expected: Array, moved: Array, share: float) -> None:
    """That they differ by no more than this share of what is expected, away from reversals."""
    kept = np.flatnonzero(~turning(moved))
    kept = kept[(kept > INSIDE.start) & (kept < moved.shape[2] - INSIDE.start)]
    off = np.sqrt(np.mean((found - expected)[:, kept] ** 2))
    assert off < share * np.sqrt(np.mean(expected[:, kept] ** 2))


@pytest.mark.parametrize("joint", [0, 1])
def test_a_late_position_is_that_of_a_time_ago(joint: int) -> None:
    """Against the motion itself at other times: 10 ms, of which 0.2 % would be a linear column."""
    time = np.tile(np.arange(6000) * H, (2, 1))
    late = time.copy()
    late[joint] -= 0.01
    seen = at(late)
    near(
        change(LatePosition.NAME, joint, 0.01, rows(seen)),
        torques(at(time)) - torques(seen),
        seen,
        2e-3,
    )


def test_a_late_torque_is_that_of_a_time_ago() -> None:
    time = np.tile(np.arange(6000) * H, (2, 1))
    expected = torques(at(time - 0.01)) - torques(at(time))
    expected[0] = 0.0
    seen = at(time)
    near(change(LateTorque.NAME, 1, 0.01, rows(seen)), expected, seen, 2e-3)


@pytest.mark.parametrize(("joint", "stiffness"), [(0, 150.0), (1, 40.0)])
def test_a_link_behind_an_elastic_gear_is_where_the_torque_leaves_it(
    joint: int, stiffness: float
) -> None:
    """The motors are ahead of the links by the torques of these, by finely sampled differences."""
    fine = 10
    time = np.tile(np.arange(6000 * fine) * H / fine, (2, 1))
    links = at(time)
    carried = MODEL.link_torques(links, THETA).T[joint]
    ahead = carried / stiffness
    step = H / fine
    motors = links.copy()
    for order in range(3):
        motors[order, joint] += ahead
        ahead = np.gradient(ahead, step)
    seen = motors[:, :, ::fine]
    beyond = (MODEL.link_torques(links, THETA) - MODEL.link_torques(motors, THETA)).T[:, ::fine]
    near(change(ElasticGear.NAME, joint, 1.0 / stiffness, rows(seen)), beyond, seen, 5e-2)


def test_a_gap_is_crossed_with_the_torque_in_the_gear() -> None:
    """Of a torque of gravity alone, by the torque at another position, away from the crossing."""
    still = np.zeros((3, 2, 2000))
    still[0] = np.array([[0.2], [0.3]]) * np.sin(np.linspace(0.0, 6.0, 2000))
    seen = rows(still)
    carried = MODEL.link_torques(still, THETA)
    moved = still.copy()
    moved[0, 1] -= 2e-3 * np.sign(carried[:, 1])
    expected = MODEL.link_torques(moved, THETA) - carried
    found = change(Backlash.NAME, 1, 2e-3, seen).T
    crossing = np.convolve(np.abs(np.gradient(np.sign(carried[:, 1]))), np.ones(9), "same") > 0
    assert np.abs(found - expected)[~crossing].max() < 1e-9


def test_a_torque_with_a_hysteresis_follows_at_a_distance() -> None:
    """The play, row by row, of a torque that reverses within the memory."""
    seen = rows(motion())
    torque, expected = torques(motion())[1], []
    now = torque[0]
    for x in torque.tolist():
        now = min(max(now, x - 0.1), x + 0.1)
        expected.append(now - x)
    found = change(Hysteresis.NAME, 1, 0.1, seen)
    assert np.all(found[0] == 0.0)
    differs = np.abs(found[1] - expected) > 1e-9
    assert np.mean(differs) < 0.02  # where the torque stays within the play for longer than that


def test_friction_builds_up_behind_a_reversal() -> None:
    """From -Fc to Fc over twice the size, in proportion to the distance."""
    q = np.concatenate((np.linspace(0.0, 1.0, 300), np.linspace(1.0, 0.0, 300)))
    still = np.zeros((3, 2, 600))
    still[0, 1], still[1, 1] = q, np.sign(np.gradient(q))
    found = change(Presliding.NAME, 1, 0.05, rows(still))[1] + ARM.value("coulomb", 2) * still[1, 1]
    behind = 1.0 - q[300:]
    expected = ARM.value("coulomb", 2) * np.maximum(1.0 - behind / 0.05, -1.0)
    assert found[302:598] == pytest.approx(expected[2:298], abs=1e-3)


def test_a_motor_oscillates_against_its_link() -> None:
    """Its inertia times the acceleration by which the gear yields."""
    seen = motion()
    carried = MODEL.link_torques(seen, THETA)[:, 1]
    expected = np.zeros((2, seen.shape[2]))
    expected[1] = 2e-4 * np.gradient(np.gradient(carried, H), H)
    near(change(ElasticJoint.NAME, 1, 2e-4, rows(seen)), expected, seen, 1e-9)


@given(parts=cuts(400))
@settings(max_examples=len(seeds(15, 100)))
def test_predictions_do_not_depend_on_the_batches(parts: Sequence[slice]) -> None:
    additions = tuple(Addition(name, j, 1.0, 1e-3) for name in MISMATCHES for j in (0, 1))
    model = Identified(ARM, THETA, 0.0, additions=additions)
    whole = replace(rows(motion(400)), bandwidth=20.0, order=4)

    def predicted(of: Sequence[slice]) -> Array:
        found = of_parts(((None, whole.part(one)) for one in of), [model], H)
        return np.concatenate([tau for _, _, (tau,) in found], axis=1)

    assert np.array_equal(predicted(parts), predicted([slice(None)]))


LATE = [
    ("position-delay", (0.0, 0.004), LatePosition.NAME, 1),
    ("position-delay", (0.006, 0.0), LatePosition.NAME, 0),
    ("torque-delay", (0.0, 0.006), LateTorque.NAME, 1),
]


@pytest.mark.parametrize(("name", "delays", "expected", "joint"), LATE)
def test_a_late_signal_of_one_joint_is_fitted(
    name: str, delays: tuple[float, ...], expected: str, joint: int
) -> None:
    """The estimates are those of a log without it, and the delay is within its interval."""
    condition = Condition("late", {name: delays})
    found, _ = blind("planar2-gravity", log(ARM, condition, 60_000))
    (addition,) = found.meta.extra["additions"]
    assert (addition["name"], addition["joint"]) == (expected, joint)
    assert abs(addition["size"] - max(delays)) < 3.0 * addition["error"] + 5e-4  # of the control
    (batch,) = found.batches
    estimates, low, high = (batch.column(c).to_numpy() for c in ("estimate", "low", "high"))
    truth = truth_of(ARM, condition)
    assert np.all(np.abs(estimates - truth) < 2.0 * (high - low))
    assert np.mean((low <= truth) & (truth <= high)) >= 0.9


def test_nothing_is_late_in_a_log_without_it() -> None:
    for seed in range(5):
        found, _ = blind("planar2-gravity", log(ARM, Condition("plain"), 61_000 + seed))
        assert not found.meta.extra.get("additions")


@pytest.mark.parametrize("frequency", [8.0, 20.0])
def test_the_stiffness_of_a_gear_is_found_within_a_tenth(frequency: float) -> None:
    """That of the inertia behind the gear at this frequency, with the motor locked."""
    name = "planar2-gravity-geared"
    robot = robot_named(name)
    condition = Condition("elastic", {"flexibility": (0.0, frequency)})
    found, _ = blind(name, log(robot, condition, 62_000))
    (addition,) = (x for x in found.meta.extra["additions"] if x["joint"] == 1)
    assert addition["name"] == ElasticGear.NAME
    stiffness = robot.value("ZZ2") * (2.0 * np.pi * frequency) ** 2
    assert addition["size"] * stiffness == pytest.approx(1.0, abs=0.1)


SIZES = {
    "backlash 0.2 deg": (Backlash.NAME, np.radians(0.1)),
    "Maxwell slip 20 mrad": (Presliding.NAME, 0.01),
    "Maxwell slip 60 mrad": (Presliding.NAME, 0.03),
}


@pytest.mark.parametrize("name", SIZES)
def test_gaps_and_presliding_are_found_with_their_sizes(name: str) -> None:
    kind, size = SIZES[name]
    condition = Condition(name, altered=CHANGES[name])
    found, _ = blind("planar2-gravity", log(ARM, condition, 63_000))
    additions = found.meta.extra["additions"]
    assert {(x["name"], x["joint"]) for x in additions} == {(kind, 0), (kind, 1)}
    assert all(abs(x["size"] - size) < 3.0 * x["error"] for x in additions)


def test_sizes_are_told_with_their_units_and_intervals() -> None:
    found = diagnosed(log_of(nothing))
    additions = (
        Addition(LatePosition.NAME, 1, 1.0, 0.004, error=1e-4),
        Addition(LateTorque.NAME, 0, 1.0, 0.002, error=2e-4),
        Addition(ElasticGear.NAME, 0, 1.0, 0.01, error=1e-4),
        Addition(ElasticJoint.NAME, 1, 1.0, (40.0 * np.pi) ** -2.0, error=1e-6),
        Addition(Backlash.NAME, 1, 1.0, 0.001, error=1e-4),
        Addition(Hysteresis.NAME, 0, 1.0, 0.2, error=0.01),
        Addition(Presliding.NAME, 1, 1.0, 0.01, error=1e-3),
    )
    told = additions_of(dict.fromkeys(ARM.names, 1.0), replace(found, additions=additions), ARM)
    assert told == [
        "there is a gap in the gear of joint 2 (backlash), with the encoder on the motor; fitted "
        "as well: 0.002 +- 0.00039 rad at joint 2",
        "something yields between encoder and link of joint 1 (an elastic gear or belt); fitted as "
        "well: at most 100 +- 2 N m/rad at joint 1 (less by the motor's part of the inertia there)",
        "motor and link of joint 2 oscillate against each other, the encoder on the link; "
        "fitted as well: 20 +- 0.31 Hz at joint 2",
        "the torque of joint 1 has a hysteresis, as of its sensor; fitted as well: 0.2 +- 0.02 N m "
        "at joint 1",
        "the position of joint 2 is older than the other signals; fitted as well: 4 +- 0.2 ms at "
        "joint 2",
        "the torque of joint 1 is older than the other signals; fitted as well: 2 +- 0.39 ms at "
        "joint 1",
        "friction of joint 2 builds up over a distance behind a reversal (presliding); fitted as "
        "well: 0.02 +- 0.0039 rad at joint 2",
    ]


def test_what_yields_or_is_late_has_a_size_above_0() -> None:
    assert all(Addition(name, 0, 1.0, 1e-3).possible for name in MISMATCHES)
    assert not any(Addition(name, 0, 1.0, -1e-3).possible for name in MISMATCHES)


def test_the_error_of_a_mean_is_that_of_independent_ones() -> None:
    sets = [[Addition(LateTorque.NAME, 0, 1.0, x, error=3e-4)] for x in (0.002, 0.004)]
    (found,) = mean_additions(sets)
    assert found.size == pytest.approx(0.003)
    assert found.error == pytest.approx(3e-4 / np.sqrt(2.0))


def test_tables_without_errors_of_what_was_fitted_are_read() -> None:
    """As those were that earlier versions wrote."""
    told = {"name": LateTorque.NAME, "joint": 0, "usual": 1.0, "size": 2e-3, "cycles": 0.0}
    assert CHECKS["additions"]([told])
    assert CHECKS["additions"]([{**told, "error": 1e-4}])
    assert CHECKS["additions"]([{**told, "error": None}])
    assert not CHECKS["additions"]([{**told, "error": -1.0}])
    assert not CHECKS["additions"]([{**told, "other": 1.0}])
