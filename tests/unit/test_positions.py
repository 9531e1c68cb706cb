"""Positions that are not those of the joints: zeros, eccentric encoders, elastic transmissions."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from unit.arms import URDF
from unit.pendulum import ARM, MODEL, H, motion
from unit.regressions import estimated

from scarid_cli.algorithms.beyond.model import Model
from scarid_cli.algorithms.beyond.positions import Elasticity, Encoders, Late, Zeros
from scarid_cli.algorithms.beyond.sensitivities import (
    Sensitivities,
    eccentric_columns,
    elastic_columns,
    zero_columns,
)
from scarid_cli.algorithms.beyond.torques import Uneven
from scarid_cli.algorithms.effects.effects import Effect
from scarid_cli.algorithms.estimators import ls
from scarid_cli.algorithms.inference.diagnostics import Diagnosis, Diagnostics
from scarid_cli.algorithms.inference.sentences import notes_of
from scarid_cli.algorithms.regression.rows import rows_of
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.arrays import Array


def torques(at: Array) -> Array:
    """The torques (samples, joints) of the links."""
    return MODEL.link_torques(at, ARM.apriori)


def with_derivatives(q: Array) -> Array:
    """Positions (joints, samples) and their first two derivatives by central differences."""
    dq = np.gradient(q, H, axis=1)
    return np.stack((q, dq, np.gradient(dq, H, axis=1)))


def cosine(q: Array, dq: Array, ddq: Array) -> Array:
    """The cosine of a position, with its first two derivatives in closed form (3, samples)."""
    return np.stack((np.cos(q), -np.sin(q) * dq, -np.sin(q) * ddq - np.cos(q) * dq**2))


def constant(q: Array, dq: Array, ddq: Array) -> Array:
    return np.stack((np.ones_like(q), 0.0 * dq, 0.0 * ddq))


@pytest.mark.parametrize(
    ("error", "columns", "of_joint_2"),
    [
        (constant, lambda s, _: zero_columns(s), 1),
        (cosine, lambda s, true: eccentric_columns(MODEL, s, true), 3),
    ],
)
def test_columns_of_encoders_are_the_change_that_their_errors_make(
    error: Callable[..., Array], columns: Callable[[Sensitivities, Array], Array], of_joint_2: int
) -> None:
    """Differences of the torques to both sides."""
    true, size = motion(400), 1e-6
    up, down = true.copy(), true.copy()
    up[:, 1] += size * error(*true[:, 1])
    down[:, 1] -= size * error(*true[:, 1])
    expected = (torques(up) - torques(down)) / (2.0 * size)
    found = columns(Sensitivities.of(MODEL, ARM.apriori, true), true)
    np.testing.assert_allclose(
        found[:, :, of_joint_2], expected, atol=1e-3 * np.abs(expected).max()
    )


def test_columns_of_elastic_transmissions_are_the_change_that_yielding_makes() -> None:
    """A joint behind an encoder on its motor is where the torque has turned it to."""
    true, stiffness = motion(400), 1e6
    carried = with_derivatives(torques(true).T)
    yielding = true.copy()
    yielding[:, 0] += carried[:, 0] / stiffness
    expected = (torques(yielding) - torques(true)) * stiffness
    found = elastic_columns(Sensitivities.of(MODEL, ARM.apriori, true), carried)
    np.testing.assert_allclose(found[:, :, 0], expected, atol=2e-3 * np.abs(expected).max())


def diagnosed(logged: Array, true: Array) -> tuple[Diagnostics, Array]:
    """The diagnostics of logged motions of an arm that moves truly so, and how far off it is."""
    tau = ARM.torques(ARM.regressor(*true), ARM.apriori)
    noise = 0.02 * np.random.default_rng(0).standard_normal(tau.shape)
    rows = rows_of(ARM, np.stack((*logged, tau + noise)), np.arange(tau.shape[1]), H)
    fit = estimated(ls.Estimator(), rows)
    found = Diagnosis(rows, fit, len(ARM.parameters), model=MODEL).diagnostics
    return found, np.abs(fit.fit.estimates - ARM.apriori)


def test_errors_of_encoders_that_other_parameters_express_are_not_tested(tmp_path: Path) -> None:
    """The zero of joint 2 turns the frame of link 2, and its first moments express that."""
    pytest.importorskip("pinocchio")
    path = tmp_path / "two.urdf"
    path.write_text(URDF.replace("TYPE", "revolute"))
    arm, true = load(str(path)), motion()
    assert {"mx2", "mz2"} <= set(arm.names)
    tau = arm.torques(arm.regressor(*true), arm.apriori)
    noise = 0.02 * np.random.default_rng(0).standard_normal(tau.shape)
    rows = rows_of(arm, np.stack((*true, tau + noise)), np.arange(tau.shape[1]), H)
    model = Model(arm, list(range(len(arm.names))))
    found = Diagnosis(
        rows, estimated(ls.Estimator(), rows), len(arm.names), model=model
    ).diagnostics
    assert (named(found, Zeros.NAME).tests, named(found, Encoders.NAME).tests) == (1, 5)


def named(found: Diagnostics, name: str) -> Effect:
    return next(effect for effect in found.effects if effect.name == name)


def test_another_zero_is_found_with_its_joint_and_its_size() -> None:
    """Joint 1 is at -0.02 rad where the log says 0."""
    true = motion()
    logged = true.copy()
    logged[0, 0] += 0.02
    found, _ = diagnosed(logged, true)
    effect = named(found, Zeros.NAME)
    assert effect.significant()
    assert abs(effect.amounts[0] + 0.02) < 3.0 * effect.noise[0] < 0.002
    (note,) = notes_of(ARM.names, found, ARM)
    assert note.startswith("where the log has a position of 0, joint 1 is at -0.0")
    # The zero of the other joint is likely to be off as well, as far as the log can tell.
    assert np.abs(effect.bias) == pytest.approx(np.hypot(effect.moved, effect.errors))
    assert not named(diagnosed(true, true)[0], Zeros.NAME).bias.any()


def eccentric(true: Array) -> Array:
    """Encoders whose error is 5 mrad times the sine of the position."""
    return with_derivatives(true[0] + 0.005 * np.sin(true[0]))


def elastic(true: Array) -> Array:
    """Motors that are ahead of their links by 1 mrad per N m."""
    return with_derivatives(true[0] + 0.001 * torques(true).T)


def late(true: Array) -> Array:
    """The position of the second joint is that of 8 ms ago."""
    q = true[0].copy()
    t = H * np.arange(q.shape[1])
    q[1] = np.interp(t - 0.008, t, q[1])
    return with_derivatives(q)


@pytest.mark.parametrize(
    ("seen", "name"), [(eccentric, Encoders.NAME), (elastic, Elasticity.NAME), (late, Late.NAME)]
)
def test_intervals_allow_for_positions_that_are_off(
    seen: Callable[[Array], Array], name: str
) -> None:
    true = motion()
    found, off = diagnosed(seen(true), true)
    assert named(found, name).significant()
    assert np.any(off > 3.0 * found.scatter)
    assert np.all(off < 3.0 * found.errors)


def test_how_late_a_position_is_is_found() -> None:
    """8 ms, with the torques of the links and with friction."""
    true = motion()
    found, _ = diagnosed(late(true), true)
    effect = named(found, Late.NAME)
    assert effect.amounts[1] == pytest.approx(0.008, abs=3.0 * effect.noise[1])
    assert effect.noise[1] < 0.0005
    for other in (0, 2, 3):  # the position of joint 1, and both torques
        assert (
            np.isnan(effect.amounts[other]) or abs(effect.amounts[other]) < 5 * effect.noise[other]
        )


def test_friction_that_varies_over_a_turn_is_found_with_its_size() -> None:
    """Coulomb friction of joint 2 plus 0.15 N m times the cosine of its position."""
    true = motion()
    tau = ARM.torques(ARM.regressor(*true), ARM.apriori)
    tau += 0.02 * np.random.default_rng(0).standard_normal(tau.shape)
    tau[1] += 0.15 * np.cos(true[0, 1]) * np.sign(true[1, 1])
    rows = rows_of(ARM, np.stack((*true, tau)), np.arange(tau.shape[1]), H)
    found = Diagnosis(
        rows, estimated(ls.Estimator(), rows), len(ARM.parameters), model=MODEL
    ).diagnostics
    effect = named(found, Uneven.NAME)
    sine, cosine = effect.amounts[1], effect.amounts[3]
    assert cosine == pytest.approx(0.15, abs=3.0 * effect.noise[3])
    assert abs(sine) < 4.0 * effect.noise[1]
    assert effect.joints(0.001, 2) == [1]
    (note,) = notes_of(ARM.names, found, ARM)
    assert note.startswith("Coulomb friction of joint 2 varies over a turn")
