"""Generalised least squares: rows weighted by joint, and whitened in time.

The residuals of weighted least squares show at which frequencies there is noise; rows are whitened
by their autocovariance (Aitken 1936; Cochrane and Orcutt 1949) and fitted again. For noise that is
not stationary, such as a torque ripple, this can be worse. Therefore the new estimates count only
if they scatter clearly less than those of wls when blocks of half a second are left out. All rows
are held in memory. No settings.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from scarid_cli.algorithms.choices.settings import GIVEN
from scarid_cli.algorithms.estimators import wls
from scarid_cli.algorithms.regression.estimation import Estimation, HoldingEstimator
from scarid_cli.algorithms.regression.information import NotIdentifiableError
from scarid_cli.algorithms.regression.rows import Rows, joined
from scarid_cli.algorithms.regression.whitening import ColouredNoise
from scarid_cli.algorithms.uncertainty.jackknife import shifts
from scarid_cli.arrays import Array

WHITENED = "whitened"  # whether the rows were, in the metadata of the parameters
CLEARLY = 0.8  # times the scatter (a variance): 5 of 240 logs with white noise are below it


@dataclass(frozen=True)
class Estimator(HoldingEstimator):
    # The number of columns at the end whose scatter does not matter.
    nuisance: int = field(default=0, metadata=GIVEN)

    def widened(self, columns: int) -> Estimator:
        return replace(self, nuisance=self.nuisance + columns)

    def quick(self) -> wls.Estimator:
        return wls.Estimator()

    def fit(self, state: list[Rows]) -> Estimation:
        rows = joined(state)
        plain = wls.Estimator().of_rows(rows)
        plain = replace(plain, extra={WHITENED: False})
        if not rows.h > 0.0:
            return plain
        noise = ColouredNoise.of(rows, plain.fit.estimates)
        white = noise.rows(rows)
        try:
            found = wls.Estimator().of_rows(white)
        except NotIdentifiableError:
            return plain
        torque = _torque(rows, rows.W.shape[2] - self.nuisance)
        if not _scatter(white, found, torque) < CLEARLY * _scatter(rows, plain, torque):
            return plain
        assert found.scores is not None
        scores = replace(found.scores, noise=noise)
        return replace(found, scores=scores, extra={WHITENED: True})


def _torque(rows: Rows, own: int) -> Array:
    """W'W of the first `own` columns, with the mean square torque of each joint as its unit."""
    counts = rows.scales > 0.0
    squares = np.sum(rows.y**2 * counts, axis=0)
    units = counts / np.sqrt(np.where(squares > 0.0, squares, 1.0))
    found = np.zeros((own, own))
    for j, unit in enumerate(units.T):  # joint by joint: a copy of W would be large
        scaled = rows.W[:, j, :own] * unit[:, None]
        found += scaled.T @ scaled
    return found


def _scatter(rows: Rows, found: Estimation, torque: Array) -> float:
    """The share of the torque that the scatter of the estimates stands for."""
    moved = shifts(rows, found)[:, : len(torque)]
    return float(np.einsum("ki,ij,kj->", moved, torque, moved))
