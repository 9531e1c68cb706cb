"""Distances between axes that are not as described."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from unit.pendulum import ARM, MODEL, H, motion
from unit.regressions import estimated

from scarid_cli.algorithms.beyond.distances import distance_columns
from scarid_cli.algorithms.beyond.model import Model
from scarid_cli.algorithms.beyond.mounting import Geometry
from scarid_cli.algorithms.estimators import ls
from scarid_cli.algorithms.inference.diagnostics import Diagnosis
from scarid_cli.algorithms.inference.sentences import notes_of
from scarid_cli.algorithms.regression.rows import rows_of
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.planar import MX2
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.arrays import Array


def longer(robot: Robot, part: float) -> Robot:
    """The planar arm whose first link is longer by this part."""
    parameters = [
        replace(p, term=replace(p.term, length=(1.0 + part) * p.term.length))
        if isinstance(p.term, MX2)
        else p
        for p in robot.parameters
    ]
    return replace(robot, parameters=tuple(parameters))


def torques(robot: Robot, true: Array) -> Array:
    return robot.torques(robot.regressor(*true), ARM.apriori)


def test_the_column_is_the_change_that_a_longer_link_makes() -> None:
    true, part = motion(400), 1e-4
    up, down = (torques(longer(ARM, s * part), true) for s in (1.0, -1.0))
    columns = distance_columns(MODEL, ARM.apriori, true)
    assert columns is not None
    expected = (up - down) / (2.0 * part)
    np.testing.assert_allclose(columns[:, :, 1].T, expected, atol=1e-6 * np.abs(expected).max())
    assert not columns[:, :, 0].any()


def test_a_longer_link_is_named_with_its_size() -> None:
    true = motion()
    tau = torques(longer(ARM, 0.05), true)
    tau += 0.02 * np.random.default_rng(0).standard_normal(tau.shape)
    rows = rows_of(ARM, np.stack((*true, tau)), np.arange(tau.shape[1]), H)
    fit = estimated(ls.Estimator(), rows)
    found = Diagnosis(rows, fit, len(ARM.parameters), model=MODEL).diagnostics
    effect = next(effect for effect in found.effects if effect.name == Geometry.NAME)
    assert effect.amounts[1] == pytest.approx(0.05, abs=3.0 * effect.noise[1])
    assert effect.significant()
    (note,) = notes_of(ARM.names, found, ARM)
    assert "the geometry is not as described: the distance from axis 1 to axis 2 is " in note
    assert "% larger" in note
    off = np.abs(fit.fit.estimates - ARM.apriori)
    assert np.any(off > 3.0 * found.scatter)
    assert np.all(off < 3.0 * found.errors)


def test_a_single_axis_has_no_distances() -> None:
    axis = load("emps")
    model = Model(axis, list(range(len(axis.names))))
    assert distance_columns(model, axis.apriori, np.zeros((3, 1, 10))) is None


def test_a_urdf_has_those_of_its_masses() -> None:
    """Beside base parameters the masses of the links count, which no log tells."""
    pytest.importorskip("pinocchio")
    arm = load("samples/arm.urdf")
    model = Model(arm, list(range(len(arm.names))))
    rng = np.random.default_rng(0)
    columns = distance_columns(model, arm.apriori, rng.uniform(-1.0, 1.0, (3, len(arm.joints), 20)))
    assert columns is not None
    assert np.abs(columns[:, :, 1:]).max() > 0.0
