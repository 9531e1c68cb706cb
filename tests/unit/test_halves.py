"""A payload that is picked up during a log, on one axis."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from unit.regressions import estimated
from unit.slow_motions import THETA, P, regression
from unit.test_effects import axis, diagnosed

from scarid_cli.algorithms.estimators import ls
from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.algorithms.statistics.diagnostics import diagnose
from scarid_cli.algorithms.statistics.halves import Halves
from scarid_cli.arrays import Array

PAYLOAD = 2.0  # kg
ALL = np.ones(4, dtype=bool)  # M, Fv, Fc and the offset


def picked_up(motion: Array) -> Array:
    """The force of a payload that the axis carries from the middle of the log on."""
    samples = motion.shape[2]
    return np.asarray(PAYLOAD * motion[2] * (np.arange(samples) >= samples // 2))


def halves(rows: Rows) -> Halves:
    found = diagnosed(rows).halves
    assert found
    return found


def refitted(rows: Rows) -> Array:
    return estimated(ls.Estimator(), rows).fit.estimates


def test_the_halves_are_those_of_separate_fits() -> None:
    rows = axis(picked_up)
    found, middle = halves(rows), rows.samples // 2
    np.testing.assert_allclose(found.first, refitted(rows.part(slice(0, middle))), rtol=1e-6)
    np.testing.assert_allclose(found.second, refitted(rows.part(slice(middle, None))), rtol=1e-6)


def test_a_payload_is_found_and_its_mass_is_the_difference() -> None:
    found = [halves(axis(picked_up, seed=seed)) for seed in range(20)]
    assert all(one.differ(ALL).tolist() == [True, False, False, False] for one in found)
    differences = [one.second[0] - one.first[0] for one in found]
    assert np.mean(differences) == pytest.approx(PAYLOAD, abs=found[0].errors[0])


def test_a_robot_that_stays_the_same_is_not_called_changed() -> None:
    """The differences of the halves are as large as their errors say."""
    ratios = []
    for seed in range(60):
        found = halves(axis(seed=seed))
        assert not found.differ(ALL).any()
        ratios.append((found.second - found.first) / found.errors)
    assert np.all(np.sqrt(np.mean(np.square(ratios), axis=0)) < 1.25)
    assert np.all(np.sqrt(np.mean(np.square(ratios), axis=0)) > 0.6)


def test_halves_that_do_not_determine_the_parameters_are_not_compared() -> None:
    """A parameter of the second half alone."""
    rows = regression(4000)
    W = rows.W.copy()
    W[:2000, :, 0] = 0.0
    rows = replace(rows, W=W, y=W @ THETA)
    assert diagnose(rows, estimated(ls.Estimator(), rows), P).halves is None
