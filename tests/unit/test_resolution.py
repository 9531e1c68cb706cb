"""The resolution of a sensor, from its readings."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from scarid_cli.algorithms.processes.resolution import resolution_of


@pytest.mark.parametrize("step", [1e-4, 0.01])
def test_the_resolution_is_that_of_the_grid(step: float) -> None:
    q = np.sin(0.003 * np.arange(5000))
    assert resolution_of(step * np.round(q / step)) == pytest.approx(step)
    assert resolution_of(q) == 0.0


@pytest.mark.parametrize(("off", "found"), [(0.03, True), (0.08, False)])
def test_steps_of_a_grid_are_whole_to_a_twentieth(*, off: float, found: bool) -> None:
    """Steps of 3 or 4 grid steps, and this much more or less, between some of a single one."""
    signs = np.resize([1.0, -1.0], 200)
    steps = np.where(np.arange(200) % 10 == 0, 1.0, np.resize([3.0, 4.0], 200) + off * signs)
    assert (resolution_of(1e-3 * np.cumsum(steps)) > 0.0) == found


@pytest.mark.parametrize("shift", [0.0, 0.3])
def test_interpolated_rows_do_not_make_the_resolution_finer(shift: float) -> None:
    """A few rows are lost, or every row lies between two readings of the sensor."""
    step = 1e-3
    t = np.arange(4000.0)
    kept = np.random.default_rng(1).random(4000) > 0.01
    readings = step * np.round(0.02 * np.sin(0.004 * t) / step)
    x = np.interp(t[1:-1] + shift, t[kept], readings[kept])
    assert np.abs(np.diff(x))[np.diff(x) != 0.0].min() < 0.6 * step
    assert resolution_of(x) == pytest.approx(step)


def test_readings_without_a_grid_and_sensors_at_rest_have_none() -> None:
    rng = np.random.default_rng(2)
    assert resolution_of(rng.standard_normal(1000)) == 0.0
    assert resolution_of(np.sin(0.1 * np.arange(4000.0))) == 0.0
    assert resolution_of(np.repeat(rng.standard_normal(500), 2)) == 0.0
    assert resolution_of(np.ones(100)) == 0.0
    assert resolution_of(np.empty(0)) == 0.0


@pytest.mark.parametrize("levels", [2, 40])
def test_positions_at_which_a_robot_stops_are_no_steps_of_a_sensor(levels: int) -> None:
    """Every 5 degrees, with smooth motions between them, of a simulator without noise."""
    stops = np.radians(5.0) * np.resize(np.r_[: levels - 1, levels - 1 : 0 : -1], 90)
    smooth = 0.5 - 0.5 * np.cos(np.pi * np.linspace(0.0, 1.0, 40))
    motions = [np.r_[a + (b - a) * smooth, np.full(60, b)] for a, b in itertools.pairwise(stops)]
    assert resolution_of(np.concatenate(motions)) == 0.0
