"""The first fit of a log, for the checks: the friction of which joint drives it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from unit.arms import sines

from scarid_cli.algorithms.checks.model import Samples, fitted
from scarid_cli.algorithms.robots.reading import load

SCARA = load("scara2")
# A description that has no friction at all: that of the log goes into the columns that are added.
RIGID = replace(SCARA, parameters=tuple(p for p in SCARA.parameters if not p.term.NEVER_NEGATIVE))


@pytest.mark.parametrize("signs", [(1, 1), (-1, 1), (1, -1), (-1, -1)])
def test_a_joint_with_negative_friction_is_found_without_friction_in_the_model(
    signs: tuple[int, int],
) -> None:
    q, dq, ddq = sines(2, 600, 1.0, 4)
    tau = RIGID.torques(RIGID.regressor(q, dq, ddq), RIGID.apriori)
    viscous, coulomb = np.array([[0.5], [0.03]]), np.array([[1.0], [0.05]])
    tau += np.array([signs]).T * (viscous * dq + coulomb * np.sign(dq))
    tau += 0.01 * np.random.default_rng(0).standard_normal(tau.shape)
    motion = np.stack((q, dq, ddq, tau, np.gradient(tau, 0.02, axis=1)))
    found = fitted(RIGID, Samples(motion, np.ones(tau.shape, dtype=np.bool_), 1.0))
    assert found.driving == [j for j in (0, 1) if signs[j] < 0]
