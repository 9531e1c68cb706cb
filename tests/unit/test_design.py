"""The optimisation of experiments: gradients, constraints and predictions."""

from __future__ import annotations

from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT

from scarid_cli.algorithms.changes.payload import directions
from scarid_cli.algorithms.design import criteria
from scarid_cli.algorithms.design.aims import AIMS
from scarid_cli.algorithms.design.constraints import Along, Constraint, Kinematic, Law, Torque
from scarid_cli.algorithms.design.geometry import Apart, Workspace
from scarid_cli.algorithms.design.information import Samples
from scarid_cli.algorithms.design.lagrangian import minimised
from scarid_cli.algorithms.design.model import Model
from scarid_cli.algorithms.design.motors import VELOCITY, Part, Shafts
from scarid_cli.algorithms.design.prediction import Moments, standard_errors, unknown
from scarid_cli.algorithms.design.problem import Problem, Wanted, kept, margins
from scarid_cli.algorithms.excitations.quintic import Excitation as Quintic
from scarid_cli.algorithms.excitations.spline import Excitation as Spline
from scarid_cli.algorithms.regression.treatment import Treatment
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.algorithms.trajectories.curve import Curve, random_curve
from scarid_cli.algorithms.trajectories.limits import Limits
from scarid_cli.algorithms.trajectories.spline import SplineBasis
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault
from scarid_cli.stages import design
from scarid_cli.stages.design import Prediction

UR10E = str(ROOT / "samples/robots/ur10e.toml")
ROBOTS = [
    "scara2",
    "emps",
    "planar2-gravity",
    str(ROOT / "samples/emps-asymmetric.toml"),
    str(ROOT / "samples/arm.toml"),
    UR10E,
]
every_robot = pytest.mark.parametrize("name", ROBOTS, ids=lambda name: Path(name).stem)
STEP = 1e-6


def motion_of(joints: int, speed: float, samples: int = 20) -> tuple[Array, Array, Array]:
    """A random motion, whose velocities are about this fast."""
    rng = np.random.default_rng(3)
    q, dq, ddq = rng.standard_normal((3, joints, samples))
    return q, dq * speed, ddq


@every_robot
def test_the_model_is_the_robot_wherever_no_axis_is_slow(name: str) -> None:
    """Friction is smooth below some .05 rad/s."""
    robot = load(name)
    q, dq, ddq = motion_of(len(robot.joints), 1.0)
    dq = np.sign(dq) * (1.0 + 0.7 * np.arange(len(dq)))[:, None]  # shafts of two joints turn too
    found = Model.of(robot).regressor((q, dq, ddq))
    np.testing.assert_allclose(found, robot.regressor(q, dq, ddq), rtol=1e-9, atol=1e-9)


@every_robot
def test_the_gradient_of_the_model_is_its_slope(name: str) -> None:
    model = Model.of(load(name))
    motion = np.array(motion_of(len(model.axes), 0.3))
    G = np.random.default_rng(0).standard_normal(model.regressor(tuple(motion)).shape)  # type: ignore[arg-type]
    found = model.gradient(tuple(motion), G)  # type: ignore[arg-type]
    for signal in range(3):
        for joint in range(len(model.axes)):
            step = np.zeros_like(motion)
            step[signal, joint] = STEP
            ahead, behind = (model.regressor(tuple(motion + s * step)) for s in (1.0, -1.0))  # type: ignore[arg-type]
            slope = ((ahead - behind) * G).sum(axis=(1, 2)) / (2.0 * STEP)
            np.testing.assert_allclose(found[signal][joint], slope, rtol=1e-5, atol=1e-4)


def boxed(robot: str) -> tuple[Samples, Limits]:
    joints = load(robot).joints
    ones = np.ones(len(joints))
    limits = Limits(-ones, ones, ones, ones)
    samples = Samples.of(SplineBasis(4.0, 4), 0.1 * ones, np.linspace(0.0, 4.0, 9))
    return samples, limits


def laws() -> dict[str, Law]:
    robot = load(UR10E)
    assert robot.body
    return {
        "torque": Torque(Model.of(robot), np.full(6, 50.0)),
        "workspace": Workspace.of(robot.body, (-0.5, 0.5, -0.6, 0.6, 0.1, 0.8)),
        "apart": Apart.of(robot.body, np.array([0.0, -1.5, 0.0, -1.5, 0.0, 0.0])),
    }


@pytest.mark.parametrize("name", ["kinematic", "torque", "workspace", "apart"])
def test_the_gradient_of_a_constraint_is_its_slope(name: str) -> None:
    samples, limits = boxed(UR10E)
    constraint: Constraint = (
        Kinematic(samples, limits) if name == "kinematic" else Along.of(samples, laws()[name])
    )
    rng = np.random.default_rng(4)
    at = 2.0 * rng.standard_normal((6, samples.values.shape[1]))
    violations, pull = constraint.evaluate(at)
    multipliers = rng.uniform(0.0, 1.0, violations.shape)
    found = pull(multipliers)
    for place in np.ndindex(at.shape):
        step = np.zeros_like(at)
        step[place] = STEP
        ahead, behind = (constraint.evaluate(at + s * step)[0] for s in (1.0, -1.0))
        slope = ((ahead - behind) * multipliers).sum() / (2.0 * STEP)
        assert found[place] == pytest.approx(slope, rel=1e-4, abs=1e-5)


def test_a_quadratic_under_limits_has_the_minimum_of_its_lagrange_conditions() -> None:
    """One joint whose acceleration may be 1: the point nearest to 2.5 and 0.2 is 1 and 0.2."""
    basis = SplineBasis(20.0, 40)  # of its functions 0 and 20, whose supports do not overlap
    places = [0, 20]

    class Two:
        duration, size, scale, summary = 20.0, 2, 0.5, ""

        def values(self, t: Array, order: int) -> Array:
            return basis.values(t, order)[places]

    samples = Samples.of(Two(), np.zeros(1), np.linspace(0.0, 20.0, 2001))
    wide = np.full(1, 1e3)
    limits = Kinematic(samples, Limits(-wide, wide, wide, np.ones(1)))
    target = np.array([[2.5, 0.2]])
    found = minimised(
        lambda c: (float(((c - target) ** 2).sum()), 2.0 * (c - target)),
        [limits],
        np.zeros((1, 2)),
        np.ones(1),
        (3.0, 30.0, 300.0, 300.0, 300.0),
        100,
    )
    assert found == pytest.approx(np.array([[1.0, 0.2]]), abs=1e-3)


def wish(name: str = "scara2", criterion: str = "balanced", duration: float = 5.0) -> Wanted:
    robot = load(name)
    limits = Limits.of(robot.joints)
    count = len(robot.parameters)
    return Wanted(
        Model.of(robot),
        SplineBasis(duration, round(2 * duration)),
        limits.home,
        limits,
        (),
        criterion,
        np.ones(len(robot.joints)),
        200.0,
        np.zeros((count, count)),
    )


def test_the_gradient_of_an_experiment_is_its_slope() -> None:
    problem = Problem.of(wish())
    at = np.random.default_rng(0).standard_normal((2, problem.wanted.basis.size))
    value, found = problem.experiment.evaluate(problem.samples, at)
    for place in ((0, 2), (1, 5)):
        step = np.zeros_like(at)
        step[place] = 1e-5
        ahead, behind = (
            problem.experiment.evaluate(problem.samples, at + s * step)[0] for s in (1.0, -1.0)
        )
        assert found[place] == pytest.approx((ahead - behind) / 2e-5, rel=1e-5)
    assert np.isfinite(value)


@pytest.mark.parametrize("criterion", criteria.NAMES)
def test_an_optimised_motion_is_better_than_its_start_and_keeps_its_limits(criterion: str) -> None:
    problem = Problem.of(wish(criterion=criterion))
    wanted = problem.wanted
    rng = np.random.default_rng((1, 0))
    start = random_curve(wanted.basis, wanted.home, wanted.limits, rng)
    found = problem.optimised(1, 0)
    assert problem.value(found) < problem.value(start) - 0.1
    t = np.linspace(0.0, wanted.basis.duration, 20_001)
    wanted.limits.require(t, *found.sample(t))


def test_a_curve_shrinks_until_its_torques_keep_their_limits() -> None:
    wanted = wish()
    curve = random_curve(wanted.basis, wanted.home, wanted.limits, np.random.default_rng(0))
    robot = load("scara2")
    t = np.arange(5001) / 1000.0
    torques = robot.torques(robot.regressor(*curve.sample(t)), robot.apriori)
    half = 0.5 * np.abs(torques).max(axis=1)
    law = Torque(wanted.model, half)
    assert margins(curve, (law,))[0] == pytest.approx(1.0, abs=1e-6)
    smaller = kept(curve, wanted.limits, (law,))
    torques = robot.torques(robot.regressor(*smaller.sample(t)), robot.apriori)
    assert np.all(np.abs(torques).max(axis=1) <= half)
    assert np.abs(torques).max() > 0.0


@pytest.mark.parametrize(("factor", "kept"), [(1.0, True), (0.999, False)])
def test_a_home_is_refused_where_its_torques_are_beyond_their_limits(
    factor: float, *, kept: bool
) -> None:
    """The EMPS at rest needs the force of its offset alone."""
    robot = load("emps")
    limit = factor * abs(robot.value("offset"))
    limited = replace(robot, joints=(replace(robot.joints[0], torque_limit=limit),))
    with nullcontext() if kept else pytest.raises(UsageFault, match="torque of joint 1"):
        assert len(design.laws(limited, np.zeros(1), None)) == 1


def test_the_slope_of_a_law_that_jumps_is_that_of_its_torque() -> None:
    """On both sides of the jump and within it; the law falls and rises with the velocity."""

    def law(u: Array) -> Array:
        return np.asarray(np.sign(u) - np.abs(u) + 0.5 * u * u)

    shaft = Shafts.of([Part(law, VELOCITY, 0, 0, np.ones(1), gain=2.0, jumps=True)])
    smooth = 0.05
    u = np.array([[-0.5, -0.06, -0.02, 0.02, 0.06, 0.5]])
    expected = (shaft.torque(u + STEP, smooth) - shaft.torque(u - STEP, smooth)) / (2.0 * STEP)
    np.testing.assert_allclose(shaft.slope(u, smooth), expected, rtol=1e-6)


def test_predicted_errors_are_those_of_simulated_estimates() -> None:
    """White noise, exact regressor, rows weighted by the noise of their joint."""
    robot = load("scara2")
    wanted = wish()
    curve = random_curve(wanted.basis, wanted.home, wanted.limits, np.random.default_rng(0))
    W = robot.regressor(*curve.sample(np.arange(1001) / 200.0))
    noise = np.array([0.2, 0.01])
    predicted = standard_errors(Moments.of([W[:400], W[400:]]).information(noise))
    rows = (W / noise[:, None]).reshape(-1, 8)
    white = np.random.default_rng(1).standard_normal((len(rows), 2000))
    estimates = np.linalg.lstsq(rows, white, rcond=None)[0]
    assert predicted == pytest.approx(estimates.std(axis=1), rel=0.06)


def test_predicted_errors_are_those_of_the_rows_that_identify_keeps_and_of_a_delay() -> None:
    robot = load("scara2")
    wanted = wish()
    curve = random_curve(wanted.basis, wanted.home, wanted.limits, np.random.default_rng(0))
    noise, slow, early = np.array([0.2, 0.01]), 0.3, 1e-5
    treatment = Treatment(slow=(slow, slow), align=True)
    nothing = np.zeros((8, 8))
    found = Prediction.of(curve, robot, 200.0, noise, nothing, treatment)
    t = np.arange(1001) / 200.0
    motion = curve.sample(t)
    W = robot.regressor(*motion)
    ahead, behind = (
        robot.regressor(*curve.sample(t[1:-1] + s * early)) @ robot.apriori for s in (1.0, -1.0)
    )
    rows = np.concatenate((W[1:-1], ((ahead - behind) / (2.0 * early))[:, :, None]), axis=2)
    rows *= ((np.abs(motion[1].T) >= slow) / noise)[1:-1, :, None]
    flat = rows.reshape(-1, 9)
    by_hand = np.sqrt(np.diag(np.linalg.inv(flat.T @ flat)))[:8]
    assert found.errors == pytest.approx(by_hand, rel=0.01)
    plain = Prediction.of(curve, robot, 200.0, noise, nothing, Treatment())
    assert np.all(plain.errors < found.errors)
    assert plain.excitation == found.excitation


def test_three_planned_experiments_tell_more_than_a_random_one_of_twice_their_time() -> None:
    """White noise, exact regressor. Coulomb friction gains least: its column is 1 in any motion."""
    robot = load("scara2")
    noise = np.array([joint.torque_noise for joint in robot.joints])
    t = np.arange(0.0, 60.0, 0.005)
    random = Quintic().trajectory(wish().limits, wish().home, 60.0, np.random.default_rng(0))
    whole = standard_errors(Moments.of([robot.regressor(*random.sample(t))]).information(noise))
    known = np.zeros((8, 8))
    basis = Spline().basis(wish().limits, 10.0)
    for start in range(3):
        wanted = replace(wish(), basis=basis, noise=noise, known=known)
        motion = Problem.of(wanted).optimised(1, start).sample(t[:2000])
        known = known + Moments.of([robot.regressor(*motion)]).information(noise)
    ratios = standard_errors(known) / whole
    assert np.exp(np.log(ratios).mean()) < 0.9
    assert {robot.names[i] for i in np.argsort(ratios)[-2:]} == {"Fs1", "Fs2"}
    assert np.sort(ratios)[-3] < 1.2  # which optimum is found depends on the rounding
    assert ratios.max() < 1.5


def test_a_parameter_that_no_row_depends_on_is_unknown() -> None:
    robot = load("scara2")
    still = Curve(SplineBasis(5.0, 5), np.zeros(2), np.zeros((2, 4)))
    coefficients = still.coefficients.copy()
    coefficients[1, 1] = 5.0  # only joint 2 moves: nothing of joint 1 but its inertial coupling
    curve = Curve(still.basis, still.home, coefficients)
    W = robot.regressor(*curve.sample(np.arange(1001) / 200.0))
    errors = standard_errors(Moments.of([W]).information(np.array([0.2, 0.01])))
    assert set(unknown(errors, robot.parameters)) >= {"ZZ1R", "Fv1", "Fs1"}
    assert np.isinf(errors[[0, 1, 2]]).all()
    assert np.isfinite(errors[robot.names.index("Fs2")])


AIMED = [
    *((name, "gains") for name in ROBOTS if len(load(name).joints) > 1),
    (UR10E, "payload"),
]


@pytest.mark.parametrize(("name", "aim"), AIMED)
def test_the_gradient_of_an_aim_is_its_slope(name: str, aim: str) -> None:
    robot = load(name)
    found = AIMS[aim](robot)
    motion = np.array(motion_of(len(robot.joints), 0.3, 6))
    columns = found.model.regressor(tuple(motion))  # type: ignore[arg-type]
    assert columns.shape[2] == found.columns
    G = np.random.default_rng(0).standard_normal(columns.shape)
    pulled = found.model.gradient(tuple(motion), G)  # type: ignore[arg-type]
    for signal in range(3):
        for joint in range(len(robot.joints)):
            step = np.zeros_like(motion)
            step[signal, joint] = STEP
            ahead, behind = (found.model.regressor(tuple(motion + s * step)) for s in (1.0, -1.0))  # type: ignore[arg-type]
            slope = ((ahead - behind) * G).sum(axis=(1, 2)) / (2.0 * STEP)
            np.testing.assert_allclose(pulled[signal][joint], slope, rtol=1e-5, atol=1e-3)


def test_the_gains_are_those_of_joints_whose_torques_are_scaled() -> None:
    """A small gain of joint 2 moves the torques along its column, and no other."""
    robot = load("planar2-gravity")
    q, dq, ddq = motion_of(2, 1.0)
    found = AIMS["gains"](robot).model.regressor((q, dq, ddq))
    torques = Model.of(robot).regressor((q, dq, ddq)) @ robot.apriori
    np.testing.assert_allclose(found[:, 1, 0], torques[:, 1])
    np.testing.assert_array_equal(found[:, 0, 0], 0.0)


def test_a_payload_moves_the_torques_along_its_wanted_columns() -> None:
    """Whatever the body: the columns that are wanted span what it adds to the torques."""
    robot = load(UR10E)
    aim = AIMS["payload"](robot)
    motion = motion_of(6, 0.5)
    columns = aim.model.regressor(motion)[:, :, : aim.wanted].reshape(-1, aim.wanted)
    body = np.array([0.3, 0.01, -0.02, 0.25, 0.03, 0.2, 0.1, -0.2, 0.15, 2.0])
    more = robot.regressor(*motion) @ (directions(robot) @ body)
    left = np.linalg.lstsq(columns, np.ravel(more), rcond=None)[0]
    np.testing.assert_allclose(columns @ left, np.ravel(more), atol=1e-9 * np.abs(more).max())
