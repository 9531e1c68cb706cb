"""A payload that is picked up during a log, on one axis."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from conftest import seeds
from unit.regressions import estimated
from unit.slow_motions import THETA, P, regression
from unit.test_effects import axis, diagnosed

from scarid_cli.algorithms.estimators import ls
from scarid_cli.algorithms.inference.diagnostics import Diagnosis
from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.algorithms.uncertainty.cuts import Cut
from scarid_cli.arrays import Array

PAYLOAD = 2.0  # kg
ALL = np.ones(4, dtype=bool)  # M, Fv, Fc and the offset


def picked_up(motion: Array) -> Array:
    """The force of a payload that the axis carries from the middle of the log on."""
    samples = motion.shape[2]
    return np.asarray(PAYLOAD * motion[2] * (np.arange(samples) >= samples // 2))


def halves(rows: Rows) -> Cut:
    """The cut in the middle."""
    return middle_of([cut for _, cut in diagnosed(rows).cuts])


def middle_of(found: list[Cut]) -> Cut:
    count = len({cut.at for cut in found})
    assert count == len(found)
    return found[count // 2]


def first(rows: Rows) -> list[tuple[float, float]]:
    """Time and size, in errors, of the cuts behind which the mass differs."""
    return [
        (time, float(abs(cut.after[0] - cut.before[0]) / cut.errors[0]))
        for time, cut in diagnosed(rows).cuts
        if cut.differ(ALL)[0]
    ]


def refitted(rows: Rows) -> Array:
    return estimated(ls.Estimator(), rows).fit.estimates


def test_the_halves_are_those_of_separate_fits() -> None:
    rows = axis(picked_up)
    found, middle = halves(rows), rows.samples // 2
    np.testing.assert_allclose(found.before, refitted(rows.part(slice(0, middle))), rtol=1e-6)
    np.testing.assert_allclose(found.after, refitted(rows.part(slice(middle, None))), rtol=1e-6)


def test_a_payload_is_found_and_its_mass_is_the_difference() -> None:
    found = [halves(axis(picked_up, seed=seed)) for seed in range(20)]
    assert all(one.differ(ALL).tolist() == [True, False, False, False] for one in found)
    differences = [one.after[0] - one.before[0] for one in found]
    assert np.mean(differences) == pytest.approx(PAYLOAD, abs=found[0].errors[0])


@pytest.mark.parametrize("share", [0.25, 0.5, 0.7])
def test_the_time_of_the_payload_is_found(share: float) -> None:
    """The clearest cut is within a tenth of the log of the change."""

    def later(motion: Array) -> Array:
        samples = motion.shape[2]
        return np.asarray(PAYLOAD * motion[2] * (np.arange(samples) >= share * samples))

    for seed in range(5):
        rows = axis(later, seed=seed)
        duration = rows.samples * rows.h
        time, _ = max(first(rows), key=lambda x: x[1])
        assert abs(time - share * duration) < 0.1 * duration


def test_a_robot_that_stays_the_same_is_not_called_changed() -> None:
    """The differences of the halves are as large as their errors say."""
    ratios = []
    for seed in seeds(30, 60):
        cuts = [cut for _, cut in diagnosed(axis(seed=seed)).cuts]
        assert not any(cut.differ(ALL).any() for cut in cuts)
        found = middle_of(cuts)
        ratios.append((found.after - found.before) / found.errors)
    assert np.all(np.sqrt(np.mean(np.square(ratios), axis=0)) < 1.25)
    assert np.all(np.sqrt(np.mean(np.square(ratios), axis=0)) > 0.6)


def test_halves_that_do_not_determine_the_parameters_are_not_compared() -> None:
    """A parameter of the second half alone."""
    rows = regression(4000)
    W = rows.W.copy()
    W[:2000, :, 0] = 0.0
    rows = replace(rows, W=W, y=W @ THETA)
    found = Diagnosis(rows, estimated(ls.Estimator(), rows), P).diagnostics.cuts
    assert all(time > 0.5 * 4000 * rows.h for time, _ in found)
