"""Direct and inverse identification, DIDIM (Gautier, Janot and Vandanjon 2013).

The parameters are those with which the simulated robot needs the logged torques. The robot is
simulated in closed loop with the previous estimates, and least squares with each joint weighted by
its residual fits the torques along the simulated motion. The log needs no positions and no soft
sensor: its torques and the reference that the robot followed (q1_ref, dq1_ref, ddq1_ref, ...) are
enough, and a measurement is taken as it was recorded. The robot description must have the
controller of the robot. All rows are held in memory. No settings.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.estimators import wls
from scarid_cli.algorithms.plants.following import simulated
from scarid_cli.algorithms.regression.estimation import Estimation, HoldingEstimator, RobotEstimator
from scarid_cli.algorithms.regression.rows import Rows, joined
from scarid_cli.errors import UsageFault

ITERATIONS = 20
CONVERGED = 1e-3  # standard errors


@dataclass(frozen=True)
class Estimator(RobotEstimator, HoldingEstimator):
    REFERENCE: ClassVar[bool] = True
    FOLLOWS: ClassVar[bool] = True
    ALIGNS: ClassVar[bool] = False

    def fit(self, state: list[Rows]) -> Estimation:
        """Start from the motion of the reference, and end with the simulated motion."""
        logged = joined(state)
        found = wls.Estimator().of_rows(logged)
        for _ in range(ITERATIONS):
            rows = simulated(self.robot, found.fit.estimates, logged)
            before, found = found, wls.Estimator().of_rows(rows)
            moved = np.abs(found.fit.estimates - before.fit.estimates)
            if np.all(moved <= CONVERGED * found.fit.standard_errors()):
                assert found.scores is not None
                return replace(found, scores=replace(found.scores, rows=rows))
        raise UsageFault(
            f"didim does not converge in {ITERATIONS} iterations: with the controller of the "
            f"description, {self.robot.name} does not follow the reference as the log does; "
            "correct [control], or use --estimator wls on the measured motion"
        )
