"""Gains of joints from the products of their rows, against fits of the rows themselves."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pyarrow as pa
import pytest
from conftest import Result
from scipy.optimize import least_squares

from scarid_cli.algorithms.changes.known_load import (
    BEFORE,
    Gains,
    Judged,
    Load,
    alone,
    scaled,
    with_load,
)
from scarid_cli.algorithms.uncertainty.joint_products import JointProducts
from scarid_cli.arrays import Array
from scarid_cli.io.table import Metadata, Table
from scarid_cli.stages.gains import freed

# Of parameters 0 to 4, 0 to 3 are shared and 4 is the friction of joint 0; joint 2 shares none
# and has parameter 5 alone. The load changes 0 by its mass and 2 by its first moment.
SEEN = np.array([[1, 1, 1, 1, 1, 0], [0, 0, 1, 1, 0, 0], [0, 0, 0, 0, 0, 1]], dtype=float)
THETA = np.array([2.0, -1.0, 1.5, 0.7, 0.4, 3.0])
B = np.zeros((6, 10))
B[0, 9], B[2, 6] = 1.0, 1.0
SHARED = np.array([True, True, True, True, False, True])
NOISE = np.array([0.02, 0.05, 0.03])
K = np.array([1.3, 0.8, 1.1])
MASS, MOMENT = 0.9, 0.2


def rows(seed: int, theta: Array, samples: int = 400) -> tuple[Array, Array]:
    """W (samples, joints, parameters) and torques (samples, joints), logged with the gains K."""
    rng = np.random.default_rng(seed)
    W = rng.standard_normal((samples, 3, 6)) * SEEN
    return W, K * (W @ theta) + NOISE * rng.standard_normal((samples, 3))


def judged(W: Array, y: Array, *biases: Array) -> Judged:
    A = np.concatenate((W, y[:, :, None], np.ones_like(y)[:, :, None]), axis=2)
    total = np.einsum("sji,sjk->jik", A, A)
    products = JointProducts.of(total, 6, (), np.full(3, float(len(W))), 1.0)
    return Judged(products, np.array(biases).reshape(-1, 6))


def logs(seed: int) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """The rows of the bare robot and of the loaded one, which has other friction."""
    loaded = THETA + B[:, 9] * MASS + B[:, 6] * MOMENT
    loaded[4] += 0.3
    return rows(seed, THETA), rows(1000 + seed, loaded)


def test_the_gains_are_those_of_a_fit_of_all_rows() -> None:
    """scipy fits the rows, weighted by the residuals of the gains that were found."""
    (W, y), (V, z) = logs(1)
    found = with_load(judged(W, y), judged(V, z), B, SHARED, Load(MASS, 0.0))
    k = found.factors
    full = found.unknowns
    theta, loaded = full[:6], np.append(full[:4], [full[6], full[5]])
    loaded = loaded + B @ full[-10:]
    weights = [1.0 / np.std(t - k * (X @ p), axis=0) for X, t, p in ((W, y, theta), (V, z, loaded))]

    def residuals(x: Array) -> Array:
        """x: the logarithms of two gains (that of joint 2 stays), theta, friction, moment."""
        gains = np.exp([x[0], x[1], found.logarithms[2]])
        bare, other = x[2:8], np.append(x[2:6], [x[8], x[7]])
        other = other + B[:, 9] * MASS + B[:, 6] * x[9]
        parts = ((W, y, bare, weights[0]), (V, z, other, weights[1]))
        return np.concatenate([((t - gains * (X @ p)) * w).ravel() for X, t, p, w in parts])

    fit = least_squares(residuals, np.ones(10), x_scale="jac", xtol=1e-14, ftol=1e-14, gtol=1e-14)
    np.testing.assert_allclose(found.logarithms[:2], fit.x[:2], atol=1e-5)
    errors = np.sqrt(np.diag(np.linalg.inv(fit.jac.T @ fit.jac)))[:2]
    np.testing.assert_allclose(found.errors[:2], errors, rtol=1e-3)


def test_intervals_contain_the_gains_as_often_as_they_say() -> None:
    inside = []
    for seed in range(100):
        (W, y), (V, z) = logs(seed)
        found = with_load(judged(W, y), judged(V, z), B, SHARED, Load(MASS, 0.0))
        inside.append(np.abs(found.logarithms - np.log(K)) < 1.96 * found.errors)
    share = np.mean(np.array(inside)[:, :2], axis=0)
    assert np.all((share > 0.88) & (share < 1.0)), share  # 2.7 deviations of 100 runs


def test_a_joint_that_shares_no_parameter_is_known_as_well_as_before() -> None:
    (W, y), (V, z) = logs(2)
    found = with_load(judged(W, y), judged(V, z), B, SHARED, Load(MASS, 0.0))
    assert found.errors[2] == pytest.approx(BEFORE, rel=0.01)
    assert found.errors[0] < 0.01
    assert found.errors[1] < 0.01


@pytest.mark.parametrize("error", [0.01, 0.05])
def test_the_mass_is_known_as_well_as_it_is_stated(error: float) -> None:
    """A mass that is wrong by a part makes all gains wrong by it, the other way round."""
    (W, y), (V, z) = logs(3)
    exact = with_load(judged(W, y), judged(V, z), B, SHARED, Load(MASS, 0.0))
    vague = with_load(judged(W, y), judged(V, z), B, SHARED, Load(MASS, error * MASS))
    heavier = with_load(judged(W, y), judged(V, z), B, SHARED, Load((1.0 + error) * MASS, 0.0))
    both = np.hypot(exact.errors[:2], error)
    np.testing.assert_allclose(vague.errors[:2], both, rtol=0.03)
    np.testing.assert_allclose(heavier.factors[:2] * (1.0 + error), exact.factors[:2], rtol=2e-3)


def test_a_centre_that_is_known_makes_gains_better_known() -> None:
    (W, y), (V, z) = logs(4)
    centre = np.array([MOMENT / MASS, 0.0, 0.0])
    alone_ = with_load(judged(W, y), judged(V, z), B, SHARED, Load(MASS, 0.0))
    beside = with_load(judged(W, y), judged(V, z), B, SHARED, Load(MASS, 0.0, centre, 1e-4))
    assert np.all(beside.errors[:2] < alone_.errors[:2])
    assert np.all(np.abs(beside.logarithms[:2] - np.log(K[:2])) < 3.0 * beside.errors[:2])


def test_a_bias_of_the_parameters_widens_by_how_far_it_moves_the_gains() -> None:
    """A loaded log with this bias has gains that are so far away."""
    (W, y), (V, z) = logs(5)
    bias = np.array([0.02, 0.0, -0.01, 0.0, 0.0, 0.0])

    def gains(loaded: Judged) -> Gains:
        return with_load(judged(W, y), loaded, B, SHARED, Load(MASS, 0.0))

    plain, wide = gains(judged(V, z)), gains(judged(V, z, bias))
    moved = gains(judged(V, z + plain.factors * (V @ bias)))
    shift = np.abs(moved.logarithms - plain.logarithms)
    assert shift[0] > plain.errors[0]
    found = np.sqrt(wide.errors**2 - plain.errors**2)
    assert found == pytest.approx(shift, rel=0.1, abs=1e-4)


def test_one_log_tells_the_gains_relative_to_one_joint() -> None:
    W, y = rows(6, THETA)
    found = alone(judged(W, y), BEFORE, {1})
    assert found.logarithms[1] == 0.0
    assert found.errors[1] == 0.0
    assert abs(found.factors[0] - K[0] / K[1]) < 3.0 * found.factors[0] * found.errors[0] < 0.02


def test_what_is_known_before_is_combined_with_the_log() -> None:
    """Two joints, each known to 10 %: their ratio is told, and their mean known to 7 %."""
    W, y = rows(7, THETA)
    found = alone(judged(W, y), 0.1, set())
    assert found.logarithms[0] - found.logarithms[1] == pytest.approx(np.log(1.3 / 0.8), abs=0.02)
    assert found.logarithms[0] + found.logarithms[1] == pytest.approx(0.0, abs=1e-3)
    assert found.errors[0] == pytest.approx(0.1 / np.sqrt(2.0), rel=0.02)
    assert found.errors[2] == pytest.approx(0.1, rel=1e-3)


def test_masses_that_are_known_fix_the_common_factor() -> None:
    W, y = rows(8, THETA)
    found = alone(judged(W, y), BEFORE, {1, 2})
    whole = scaled(found, THETA, np.array([0, 1, 2, 3]), {2})
    np.testing.assert_allclose(whole.factors[:2], K[:2], rtol=0.01)
    assert whole.factors[2] == 1.0
    apriori = THETA * np.array([1.1, 0.9, 1.05, 1.0, 1.0, 1.0])
    vague = scaled(found, apriori, np.array([0, 1, 2, 3]), {2})
    assert vague.errors[0] > 2.0 * whole.errors[0]


def test_the_other_columns_are_fitted_to_each_joint_and_left_out() -> None:
    """Frisch, Waugh and Lovell: the residuals of a fit by the other columns."""
    rng = np.random.default_rng(9)
    A = rng.standard_normal((50, 2, 6))  # 2 own columns, 2 others, the torque, ones
    A[:, :, 3] = A[:, :, 2] * (1.0 + 1e-12)  # one of them twice
    total = np.einsum("sji,sjk->jik", A, A)
    found = JointProducts.of(total, 2, (), np.full(2, 50.0), 1.0)
    for j in range(2):
        own, other = A[:, j, [0, 1, 4]], A[:, j, 2:3]
        left = own - other @ np.linalg.lstsq(other, own, rcond=None)[0]
        np.testing.assert_allclose(found.values[j], left.T @ left, rtol=1e-9)
    kept = JointProducts.of(total, 2, (2, 3), np.full(2, 50.0), 1.0)
    np.testing.assert_allclose(kept.values[0], A[:, 0, [0, 1, 4]].T @ A[:, 0, [0, 1, 4]])


def test_errors_grow_with_the_inflation_by_autocorrelated_noise() -> None:
    (W, y), _ = logs(10)
    one = judged(W, y)
    four = replace(one, products=replace(one.products, inflation=4.0))
    narrow, wide = (alone(x, 1e3, {1, 2}) for x in (one, four))
    assert wide.errors[0] == pytest.approx(2.0 * narrow.errors[0], rel=1e-6)


@pytest.mark.parametrize(
    ("extra", "anchor"),
    [
        ({}, None),
        ({"relative_gains": {"1": [1.004, 0.003], "3": [0.999, 0.001]}}, None),
        ({"relative_gains": {"1": [1.004, 0.003], "3": [1.247, 0.002]}}, 2),
        ({"relative_gains": {"2": [1.247, 0.002]}}, 1),
        ({"relative_gains": {"2": [1.247, 0.002]}, "torque_gains": [1.0, 1.25]}, None),
    ],
)
def test_what_a_wrong_gain_makes_vague_is_identified_with_free_gains(
    extra: dict[str, object], anchor: int | None
) -> None:
    bare = Table("bare", pa.schema([]), Metadata(kind="parameters", extra=extra), iter(()))
    said = freed(bare)
    assert (f"`scarid identify --free-gains {anchor}`" in said) == (anchor is not None)
    assert bool(said) == (anchor is not None)


def test_a_gain_that_changed_between_the_logs_is_refused(shell: Callable[..., Result]) -> None:
    """Of neither log is it what both say together."""
    made = shell(
        "export SCARID_ROBOT=$SAMPLES/arm.toml;"
        " scarid trajgen -q --seed 3 --duration 8 -o motion.parquet;"
        " scarid simulate -q --seed 1 motion.parquet | scarid identify -q -o bare.parquet;"
        " scarid simulate -q --seed 2 --with torque-constant-error=0.2,0"
        " --with payload=0.5,0.05,0,0,0,0,0,0,0,0,0 motion.parquet -o loaded.parquet"
    )
    assert made.status == 0, made.err
    done = shell("scarid gains -q --parameters bare.parquet --mass 0.5 loaded.parquet")
    assert done.status == 65
    assert "a gain changed between the logs" in done.err
