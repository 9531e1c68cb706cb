"""Statistics that are to be believed: errors, delays, essential parameters, the verdict."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.stats
from hypothesis import given
from hypothesis import strategies as st

from scarid_cli.algorithms.estimators import irls, iv, ls, ml, wls
from scarid_cli.algorithms.regression.information import Fit, weakest
from scarid_cli.algorithms.regression.rows import Rows, joined, plain, rows_of, runs, with_delay
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.algorithms.statistics.blocks import Blocks
from scarid_cli.algorithms.statistics.diagnostics import (
    Diagnostics,
    Joint,
    diagnose,
    jackknife,
    t95,
)
from scarid_cli.algorithms.statistics.essential import RATIO, essential, without
from scarid_cli.algorithms.statistics.subsample import Subsample
from scarid_cli.algorithms.statistics.verdict import Evidence, combination, verdict
from scarid_cli.arrays import Array

H = 0.005
P = 3
THETA = np.array([2.0, -1.0, 0.5])
SCARA = load("scara2")


def smooth(samples: int, columns: int, rng: np.random.Generator, reach: int = 20) -> Array:
    """Columns that change slowly, as motions do."""
    kernel = np.hanning(2 * reach + 1)
    noise = rng.standard_normal((samples + 2 * reach, columns))
    return np.column_stack([np.convolve(x, kernel, "valid") for x in noise.T])


def regression(samples: int = 2000, seed: int = 0, *, coloured: bool = True) -> Rows:
    """One joint with slow regressors and noise that is slow as well, or white."""
    rng = np.random.default_rng(seed)
    W = smooth(samples, P, rng)
    noise = smooth(samples, 1, rng)[:, 0] if coloured else rng.standard_normal(samples)
    return plain(W[:, None, :], (W @ THETA + noise)[:, None])


def fitted(rows: Rows) -> Fit:
    estimator = ls.Estimator()
    return estimator.fit(estimator.step(estimator.init(np.zeros(rows.W.shape[2])), rows)[0])


# Errors


def test_leaving_blocks_out_is_a_refit_without_them() -> None:
    """The first-order formula is exact for least squares: against refits without each block."""
    rows = regression()
    fit = fitted(rows)
    covariance, blocks = jackknife(rows, fit, H)
    refits = []
    for b in range(blocks):
        kept = np.arange(rows.samples) * blocks // rows.samples != b
        refits.append(fitted(plain(rows.W[kept], rows.y[kept])).estimates - fit.estimates)
    expected = (blocks - 1) / blocks * np.array(refits).T @ np.array(refits)
    np.testing.assert_allclose(covariance, expected, rtol=1e-8)


def test_errors_of_autocorrelated_residuals_are_those_that_occur() -> None:
    """Over 300 experiments: the robust ones are right, those of white residuals far too small."""
    found = []
    for seed in range(300):
        rows = regression(seed=seed)
        fit = fitted(rows)
        robust = np.sqrt(np.diag(jackknife(rows, fit, H)[0]))
        found.append((fit.estimates - THETA, robust, fit.standard_errors()))
    errors, robust, white = (np.array(x) for x in zip(*found, strict=True))
    occurred = errors.std(axis=0)
    np.testing.assert_allclose(np.median(robust, axis=0), occurred, rtol=0.2)
    assert np.all(np.median(white, axis=0) < 0.4 * occurred)


def test_errors_of_white_residuals_are_the_classical_ones() -> None:
    rows = regression(20_000, coloured=False)
    fit = fitted(rows)
    robust = np.sqrt(np.diag(jackknife(rows, fit, H)[0]))
    np.testing.assert_allclose(robust, fit.standard_errors(), rtol=0.25)


@pytest.mark.parametrize("estimator", [wls, ml, irls], ids=["wls", "ml", "irls"])
def test_robust_errors_follow_the_weights_of_the_estimator(estimator: object) -> None:
    """White noise: they are near the classical ones, for which the weights are as they are."""
    rng = np.random.default_rng(0)
    W = np.stack([smooth(8000, P, rng) for _ in range(2)], axis=1)
    rows = plain(W, W @ THETA + rng.standard_normal((8000, 2)) * [10.0, 0.1])
    solver = estimator.Estimator()  # type: ignore[attr-defined]
    fit = solver.fit(solver.step(solver.init(np.zeros(P)), rows)[0])
    robust = np.sqrt(np.diag(jackknife(rows, fit, H)[0]))
    np.testing.assert_allclose(robust, fit.standard_errors(), rtol=0.25)


@pytest.mark.parametrize("freedom", [5, 9, 19, 39, 127])
def test_quantiles_of_student_are_those_of_scipy(freedom: int) -> None:
    assert t95(freedom) == pytest.approx(scipy.stats.t.ppf(0.975, freedom), rel=2e-3)


def test_residual_facts_are_those_of_numpy() -> None:
    rows = regression()
    fit = fitted(rows)
    (joint,) = diagnose(rows, fit, H, P).joints
    residual = (rows.y - rows.W @ fit.estimates)[:, 0]
    y = rows.y[:, 0]
    assert joint.rows == len(y)
    assert joint.r2 == pytest.approx(1.0 - residual.var() / y.var(), abs=1e-3)
    assert joint.deviation == pytest.approx(np.sqrt(np.mean(residual**2)))
    assert joint.autocorrelation == pytest.approx(np.corrcoef(residual[1:], residual[:-1])[0, 1],
                                                  abs=0.01)  # fmt: skip
    assert joint.kurtosis == pytest.approx(scipy.stats.kurtosis(residual))


# Do the signals belong together?


def test_the_neighbours_explain_nothing_where_all_is_well() -> None:
    rows = regression(8000, coloured=False)
    assert diagnose(rows, fitted(rows), H, P).lag_share < 0.01


@pytest.mark.parametrize("late", [-10, -3, 3, 10])
def test_the_neighbours_explain_torques_of_another_instant(late: int) -> None:
    rows = regression(8000, coloured=False)
    shifted = plain(rows.W[20:-20], np.roll(rows.y, late, axis=0)[20:-20])
    assert diagnose(shifted, fitted(shifted), H, P).lag_share > 0.5


@given(lead=st.floats(-2e-3, 2e-3))
def test_the_delay_of_the_torques_is_found(lead: float) -> None:
    """Torques of sines, a little early or late; the estimates are as without the delay."""
    t = np.arange(4000) * H

    def regressor(at: Array) -> Array:
        return np.stack([np.sin(at), np.cos(1.7 * at), np.sin(2.3 * at)], axis=1)[:, None, :]

    rows = plain(regressor(t), regressor(t + lead) @ THETA)
    fit = fitted(rows)
    for _ in range(3):
        fit = fitted(with_delay(rows, fit.estimates, H))
    assert fit.estimates[P] == pytest.approx(lead, abs=2e-6)
    np.testing.assert_allclose(fit.estimates[:P], THETA, atol=1e-4)


# Instruments


def test_instruments_are_not_attenuated_and_hausman_tells() -> None:
    """Noise in the regressor, none in the instruments: least squares is off, and this is told."""
    rng = np.random.default_rng(4)
    W = smooth(8000, P, rng)[:, None, :]
    y = W @ THETA + rng.standard_normal((8000, 1))
    spoilt = plain(W + rng.standard_normal(W.shape) * W.std(), y)
    start = wls.Estimator()
    least = start.fit(start.step(start.init(np.zeros(P)), spoilt)[0])
    fit = iv._solved(spoilt, W, least)
    assert np.all(np.abs(fit.estimates - THETA) < 5.0 * fit.standard_errors())
    assert np.abs(least.estimates - THETA).max() > 0.5
    assert iv.hausman(spoilt, least, fit, H)[1] < 1e-6
    clean = plain(W, y)
    right = start.fit(start.step(start.init(np.zeros(P)), clean)[0])
    other = iv._solved(clean, W + rng.standard_normal(W.shape) * W.std(), right)
    assert iv.hausman(clean, right, other, H)[1] > 0.01


# Essential parameters


def test_without_a_parameter_is_a_refit_without_its_column() -> None:
    rows = regression()
    fit = fitted(rows)
    theta, covariance = without(fit.estimates, fit.unit_covariance, 1)
    refit = fitted(plain(rows.W[:, :, [0, 2]], rows.y))
    np.testing.assert_allclose(theta[[0, 2]], refit.estimates, rtol=1e-9)
    np.testing.assert_allclose(covariance[np.ix_([0, 2], [0, 2])], refit.unit_covariance, rtol=1e-9)


def test_what_is_not_known_is_dropped_and_its_cost_told() -> None:
    rng = np.random.default_rng(1)
    W = rng.standard_normal((5000, 1, P))
    truth = np.array([5.0, 1e-5, 1.0])
    rows = plain(W, W @ truth + 0.1 * rng.standard_normal((5000, 1)))
    fit = fitted(rows)
    found = essential(fit, 5000.0)
    assert found.dropped == (1,)
    assert found.fit.estimates[1] == 0.0
    refit = fitted(plain(W[:, :, [0, 2]], rows.y))
    np.testing.assert_allclose(found.fit.estimates[[0, 2]], refit.estimates, rtol=1e-9)
    assert found.fit.variance == pytest.approx(refit.variance, rel=1e-9)
    cost = np.sqrt(refit.variance * 4998 / (fit.variance * 4997)) - 1.0
    assert found.cost == pytest.approx(cost, rel=1e-6)
    errors = found.fit.standard_errors()
    relative = errors[[0, 2]] / np.abs(refit.estimates)
    assert relative.max() < RATIO * relative.min()


# Rows


def test_rows_of_slow_joints_are_left_out_joint_by_joint() -> None:
    motion = np.ones((4, 2, 3))
    motion[1] = [[0.05, -0.05, 0.2], [1.0, -1.0, 0.0]]
    rows = rows_of(SCARA, motion, np.arange(3), slow=np.array([0.1, 0.1]))
    assert rows.scales.tolist() == [[0.0, 1.0], [0.0, 1.0], [1.0, 0.0]]


def test_runs_end_at_gaps() -> None:
    at = np.array([0, 1, 2, 5, 6, 9])
    assert [at[run].tolist() for run in runs(at)] == [[0, 1, 2], [5, 6], [9]]


SIZES = [(1000,), (7, 300), (8192,)]


def fed(state: Subsample | Blocks, rows: Rows, sizes: tuple[int, ...]) -> Subsample | Blocks:
    """After rows in batches of these sizes, over and over."""
    start = turn = 0
    while start < rows.samples:
        size = sizes[turn % len(sizes)]
        state = state.add(rows.part(slice(start, start + size)))
        start, turn = start + size, turn + 1
    return state


@pytest.mark.parametrize("sizes", SIZES)
@pytest.mark.parametrize("thinnest", [1, 5])
def test_a_witness_is_the_same_however_rows_arrive_and_stays_small(
    sizes: tuple[int, ...], thinnest: int
) -> None:
    W = np.arange(60_000.0).reshape(-1, 1, 1)
    rows = plain(W, W[:, :, 0])
    begun = Subsample(samples=5_000, thinnest=thinnest)
    subsample = fed(begun, rows, sizes)
    assert isinstance(subsample, Subsample)
    kept = subsample.rows()
    assert subsample.total == subsample.counted == rows.samples
    assert not subsample.complete
    assert 1_250 <= kept.samples <= 5_000
    assert subsample.thin == {1: 1, 5: 4}[thinnest]
    np.testing.assert_array_equal(kept.W[:, 0, 0], kept.at * subsample.thin)
    np.testing.assert_array_equal(kept.at, begun.add(rows).rows().at)


def test_a_witness_is_thinned_before_segments_are_dropped() -> None:
    """So that it covers the whole of a record at a high rate."""
    W = np.arange(18_000.0).reshape(-1, 1, 1)
    subsample = Subsample(samples=5_000, thinnest=5).add(plain(W, W[:, :, 0]))
    kept = subsample.rows()
    assert (subsample.thin, subsample.stride) == (4, 1)
    np.testing.assert_array_equal(kept.at, np.arange(18_000 // 4))


@pytest.mark.parametrize("sizes", SIZES)
def test_blocks_have_the_same_bits_however_rows_arrive(sizes: tuple[int, ...]) -> None:
    rows = regression(60_000)
    gapped = rows.taken(np.flatnonzero((rows.at < 20_000) | (rows.at > 31_234)))
    whole, cut = (fed(Blocks.every(H), gapped, s).whole() for s in ((10**6,), sizes))
    assert isinstance(cut, Blocks)
    assert isinstance(whole, Blocks)
    assert (cut.numbers, cut.length) == (whole.numbers, whole.length)
    np.testing.assert_array_equal(cut.products, whole.products)
    assert len(cut.numbers) <= 128


def test_blocks_hold_the_products_of_all_rows_that_count() -> None:
    rows = regression(5_000)
    rows = replace(rows, scales=np.where(np.arange(5_000)[:, None] % 3 == 0, 0.0, 2.0))
    total = sum(Blocks.every(H).add(rows).whole().products)
    both = np.concatenate((rows.W, rows.y[:, :, None]), axis=2) * rows.scales[:, :, None]
    for joint, products in enumerate(total):
        np.testing.assert_allclose(products, both[:, joint].T @ both[:, joint], rtol=1e-10)


def test_errors_of_a_long_record_are_those_of_its_rows() -> None:
    """By blocks, and by the rows themselves: blocks end elsewhere, so to a tenth."""
    rows = regression(40_000)
    fit = fitted(rows)
    by_rows = diagnose(rows, fit, H, P)
    by_blocks = diagnose(rows, fit, H, P, Blocks.every(H).add(rows).whole())
    np.testing.assert_allclose(by_blocks.errors, by_rows.errors, rtol=0.3)
    assert by_blocks.errors.mean() == pytest.approx(by_rows.errors.mean(), rel=0.1)


def test_joined_parts_are_the_whole() -> None:
    rows = regression(100)
    again = joined([rows.part(slice(0, 30)), rows.part(slice(30, 100))])
    np.testing.assert_array_equal(again.W, rows.W)
    np.testing.assert_array_equal(again.at, rows.at)


# The verdict

GOOD = Joint(1000, 0.999, 0.1, 0.1, 2.0, 0.0, 5.0)


def evidence(**changes: object) -> Evidence:
    diagnostics = Diagnostics(
        errors=0.01 * np.ones(8),
        quantile=2.0,
        joints=(GOOD, replace(GOOD, torque=0.5)),
        lag_share=0.1,
        moved=np.zeros(8),
        slow=np.full(2, 0.1),
    )
    plain_evidence = Evidence(
        names=SCARA.names,
        estimates=np.ones(8),
        errors=0.01 * np.ones(8),
        condition=20.0,
        scaled_condition=5.0,
        weak="Fv1 - Fs1",
        diagnostics=diagnostics,
    )
    changed = {k: v for k, v in changes.items() if k in vars(plain_evidence)}
    others = {k: v for k, v in changes.items() if k not in changed}
    return replace(plain_evidence, diagnostics=replace(diagnostics, **others), **changed)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("changes", "grade", "reason"),
    [
        ({}, "good", "8 of 8 parameters known within 30 %, R2 0.9990, 0.9990, condition number 20"),
        ({"lag_share": 0.8}, "doubtful", "biased: the motion 25 ms before and after explains 80 %"),
        ({"moved": np.eye(8)[1] * -4.0}, "doubtful", "Fv1 would move by up to 4.0 deviations"),
        (
            {"joints": (GOOD, replace(GOOD, r2=0.3, torque=0.5))},
            "doubtful",
            "explains the torque of joint 2 badly",
        ),
        ({"estimates": -np.ones(8)}, "doubtful", "Fv1 is negative"),
        ({"errors": np.full(8, 0.5)}, "doubtful", "0 of 8 parameters known within 30 %"),
        ({"scaled_condition": 1e6}, "not identifiable", "hardly determines Fv1 - Fs1"),
        (
            {"joints": (GOOD, replace(GOOD, torque=0.01))},
            "not identifiable",
            "joint 2 has hardly any torque (0.01 N m rms",
        ),
    ],
    ids=lambda x: next(iter(x), "nothing") if isinstance(x, dict) else None,
)
def test_the_verdict_says_what_is_wrong(
    changes: dict[str, object], grade: str, reason: str
) -> None:
    judged = verdict(evidence(**changes), SCARA)
    assert judged.grade == grade
    assert any(reason in found for found in judged.reasons), judged.reasons


def test_a_parameter_of_zero_is_named_but_no_reason_for_doubt() -> None:
    estimates = np.ones(8)
    estimates[5] = 1e-3
    judged = verdict(evidence(estimates=estimates), SCARA)
    assert judged.grade == "good"
    assert judged.reasons[-1] == "not L1MY2"


def test_the_weakest_direction_is_that_of_the_smallest_singular_value() -> None:
    """Whatever the units: W with columns of unit length."""
    rng = np.random.default_rng(0)
    W = rng.standard_normal((100, P)) * [1.0, 1e3, 1e-3]
    W[:, 2] = 1e-3 * (W[:, 0] - 1e-3 * W[:, 1] + 1e-3 * rng.standard_normal(100))
    unit = W / np.linalg.norm(W, axis=0)
    singular = np.linalg.svd(unit)[1]
    inverse = np.linalg.inv(np.linalg.qr(W)[1])
    condition, direction = weakest(inverse @ inverse.T)
    assert condition == pytest.approx(singular[0] / singular[-1], rel=1e-6)
    moved = np.linalg.norm(W @ direction) / np.linalg.norm(W * direction)
    assert moved < 2e-3


def test_a_direction_is_written_out() -> None:
    assert combination(np.array([2.0, -1.0, 0.01]), ["a", "b", "c"]) == "a - 0.5 b"
    assert combination(np.array([0.0, -3.0, 0.0]), ["a", "b", "c"]) == "b"
