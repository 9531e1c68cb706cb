"""Variable forgetting: against a plain Kalman filter, on robots that stay, warm up, and carry."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scarid_cli.algorithms.estimators import adaptive, rls
from scarid_cli.algorithms.estimators.adaptive import Bank, Estimator
from scarid_cli.algorithms.regression.information import NotIdentifiableError
from scarid_cli.algorithms.regression.rows import Rows, rows_of
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.algorithms.uncertainty.checkpoint import Checkpoint
from scarid_cli.arrays import Array
from scarid_cli.stages.results.continuation import restored, saved

ROBOT = load("scara2")
H = 0.005
RUBS = np.array([p.term.NEVER_NEGATIVE for p in ROBOT.parameters])


def log(factor: Array, seed: int = 0) -> tuple[Rows, Array]:
    """Rows of a motion with friction times these factors (samples), and the parameters."""
    rng = np.random.default_rng(seed)
    t = H * np.arange(len(factor))
    phases = rng.uniform(0.0, 6.0, (2, 3, 1))
    rates = np.array([[1.3, 2.9, 4.3], [1.7, 3.7, 5.9]])[:, :, None]
    q = np.sum(np.sin(rates * t + phases), axis=1) * 0.5
    dq = np.sum(rates * np.cos(rates * t + phases), axis=1) * 0.5
    ddq = -np.sum(rates**2 * np.sin(rates * t + phases), axis=1) * 0.5
    theta = ROBOT.apriori * np.where(RUBS, factor[:, None], 1.0)
    tau = np.einsum("sjp,sp->js", ROBOT.regressor(q, dq, ddq), theta)
    noise = 0.02 * np.sqrt(np.mean(tau**2, axis=1, keepdims=True))
    tau += noise * rng.standard_normal(tau.shape)
    return rows_of(ROBOT, np.stack((q, dq, ddq, tau)), np.arange(len(t)), H), theta


def running(estimator: Estimator | rls.Estimator, rows: Rows) -> Array:
    own = estimator.for_robot(ROBOT)
    return own.step(own.init(np.zeros(len(ROBOT.names))), rows, trace=True)[1]


def off(estimator: Estimator | rls.Estimator, rows: Rows, theta: Array) -> float:
    """The error of the running estimates as a torque, from 5 s on, relative to it."""
    late = slice(1000, None)
    found = running(estimator, rows)[late]
    miss = np.einsum("sjp,sp->sj", rows.W[late], found - theta[late])
    size = np.einsum("sjp,sp->sj", rows.W[late], theta[late])
    return float(np.sqrt(np.mean(miss**2, axis=0) / np.mean(size**2, axis=0)).mean())


def test_a_block_is_absorbed_as_by_a_plain_kalman_filter() -> None:
    """Row by row in covariance form, with the likelihood of its innovations."""
    rows, _ = log(np.ones(40))
    p = len(ROBOT.names)
    rng = np.random.default_rng(1)
    root = rng.standard_normal((p, p))
    P, m = root @ root.T + np.eye(p), rng.standard_normal(p)
    W, y = rows.W.reshape(-1, p), rows.y.ravel()
    bank = Bank(
        means=np.array([m, m]), covariances=np.array([P, 4.0 * P]), weights=np.array([0.5, 0.5]),
        gram=np.zeros((p, p)), noise=np.ones(2), torque=np.ones(2), alike=np.ones(2),
    )  # fmt: skip
    found = Estimator()._updated(bank, W.T @ W, W.T @ y, float(y @ y))
    logs = []
    for k, start in enumerate((P, 4.0 * P)):
        C, x, likelihood = start.copy(), m.copy(), 0.0
        for w, tau in zip(W, y, strict=True):
            variance = w @ C @ w + 1.0
            gain = C @ w / variance
            likelihood -= 0.5 * (np.log(variance) + (tau - w @ x) ** 2 / variance)
            x = x + gain * (tau - w @ x)
            C = C - np.outer(gain, w @ C)
        logs.append(likelihood)
        np.testing.assert_allclose(found.means[k], x, rtol=1e-6, atol=1e-8)
        np.testing.assert_allclose(found.covariances[k], C, rtol=1e-5, atol=1e-9)
    expected = np.exp(np.array(logs) - max(logs))
    np.testing.assert_allclose(found.weights, expected / expected.sum(), rtol=1e-6)


def test_a_robot_that_stays_as_it_is_is_hardly_forgotten() -> None:
    ratios = [
        off(Estimator(), *made) / off(rls.Estimator(), *made)
        for made in (log(np.ones(12_000), seed) for seed in range(4))
    ]
    assert np.median(ratios) < 1.5


def test_warming_friction_is_followed() -> None:
    """As well as by the constant factor that is best in hindsight, which nobody knows."""
    t = H * np.arange(12_000)
    rows, theta = log(1.0 + 0.5 * (1.0 - np.exp(-t / 20.0)))
    plain = off(rls.Estimator(), rows, theta)
    best = min(off(rls.Estimator(forgetting=1 - H / s), rows, theta) for s in (1, 2, 5, 10, 20, 50))
    found = off(Estimator(), rows, theta)
    assert found < 0.5 * plain
    assert found < 1.3 * best


def test_a_jump_is_followed_within_a_second() -> None:
    factor = np.ones(8000)
    factor[4000:] = 1.5
    rows, theta = log(factor)
    estimates = running(Estimator(), rows)
    coulomb = [i for i, name in enumerate(ROBOT.names) if name.startswith("Fs")]
    after = estimates[4000 + round(1.0 / H), coulomb] / theta[-1, coulomb]
    assert np.all(np.abs(after - 1.0) < 0.15)
    before = estimates[3999, coulomb] / theta[0, coulomb]
    assert np.all(np.abs(before - 1.0) < 0.1)


@given(sizes=st.lists(st.integers(1, 90), min_size=1, max_size=5))
@settings(max_examples=15, deadline=None)
def test_chunks_do_not_change_a_bit(sizes: list[int]) -> None:
    rows, _ = log(np.ones(900))
    whole = running(Estimator(), rows)
    own = Estimator().for_robot(ROBOT)
    state, parts, start, turn = own.init(np.zeros(len(ROBOT.names))), [], 0, 0
    while start < rows.samples:
        part = rows.part(slice(start, start + sizes[turn % len(sizes)]))
        state, found = own.step(state, part, trace=True)
        parts.append(found)
        start, turn = start + part.samples, turn + 1
    np.testing.assert_array_equal(np.concatenate(parts), whole)
    fit = own.fit(own.step(own.init(np.zeros(len(ROBOT.names))), rows)[0]).fit
    np.testing.assert_array_equal(own.fit(state).fit.estimates, fit.estimates)


def test_the_errors_are_those_of_the_estimates() -> None:
    """Of a robot that stays: within three times."""
    ratios = []
    for seed in range(8):
        rows, _ = log(np.ones(4000), seed)
        own = Estimator().for_robot(ROBOT)
        fit = own.fit(own.step(own.init(np.zeros(len(ROBOT.names))), rows)[0]).fit
        ratios.append((fit.estimates - ROBOT.apriori) / np.sqrt(np.diag(fit.unit_covariance)))
    size = np.sqrt(np.mean(np.square(ratios), axis=0))
    assert np.all(size < 2.0)
    assert np.all(size > 0.2)


def test_a_joint_that_does_not_move_is_not_identifiable() -> None:
    rows, _ = log(np.ones(400))
    W = rows.W.copy()
    W[:, :, 0] = 0.0
    own = Estimator().for_robot(ROBOT)
    state, _ = own.step(own.init(np.zeros(len(ROBOT.names))), replace(rows, W=W))
    with pytest.raises(NotIdentifiableError):
        own.fit(state)


def test_memory_does_not_grow() -> None:
    rows, _ = log(np.ones(6000))
    own = Estimator().for_robot(ROBOT)
    state, _ = own.step(own.init(np.zeros(len(ROBOT.names))), rows)
    held = sum(x.samples for x in (*state.held, *state.window))
    assert held <= (adaptive.LONGEST + 1) * round(adaptive.BLOCK / H)


def test_a_saved_estimation_goes_on_as_if_it_had_not_ended(tmp_path: Path) -> None:
    """The state is a dataclass of arrays, which --save writes and --from reads."""
    rows, _ = log(np.ones(2600))
    own = Estimator().for_robot(ROBOT)
    start = Checkpoint.at_start(own.init(np.zeros(len(ROBOT.names))), H)
    half, _ = own.step(start.state, rows.part(slice(0, 1313)))
    path = tmp_path / "state.npz"
    path.write_bytes(saved(replace(start, state=half), {}))
    again = restored(str(path), {}, own, ROBOT).state
    rest = rows.part(slice(1313, None))
    np.testing.assert_array_equal(
        own.fit(own.step(half, rest)[0]).fit.estimates,
        own.fit(own.step(again, rest)[0]).fit.estimates,
    )
