"""How many periods per rad the torque ripple of a joint has, behind the low-pass of the rows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt
from unit.pendulum import ARM, H, motion

from scarid_cli.algorithms.beyond.ripple import Ripples, gain
from scarid_cli.algorithms.filters.two_sided import two_sided_bandwidth
from scarid_cli.algorithms.regression.rows import Rows, rows_of
from scarid_cli.arrays import Array

CUTOFF = 8.0  # Hz
NOISE = 0.02  # N m


def rows(beyond: Array | None = None) -> Rows:
    """Rows of which everything has passed a Butterworth filter of order 4, both ways."""
    true = motion()
    torque = ARM.torques(ARM.regressor(*true), ARM.apriori)
    torque = torque + NOISE * np.random.default_rng(0).standard_normal(torque.shape)
    measured = np.stack((*true, torque if beyond is None else torque + beyond))
    low_pass = butter(4, CUTOFF, fs=1.0 / H, output="sos")
    found = rows_of(ARM, sosfiltfilt(low_pass, measured, axis=2), np.arange(measured.shape[2]), H)
    return replace(found, bandwidth=CUTOFF * two_sided_bandwidth(4), order=4)


@pytest.mark.parametrize("cycles", [(2.0, 7.3), (11.0, 4.9), (3.0, 3.0)])
def test_the_periods_of_each_joint_are_found(cycles: tuple[float, float]) -> None:
    """Within a tenth of a period over the range of the joint."""
    q = motion()[0]
    found = rows(0.1 * np.cos(2.0 * np.pi * np.array(cycles)[:, None] * q + 0.4))
    off = Ripples.of(found).cycles[0] - cycles
    assert np.all(np.abs(off) * np.ptp(q, axis=1) < 0.1)


def test_further_ripples_of_a_joint_are_found_the_largest_first() -> None:
    """Three harmonics, of which the second is the largest; the other joint has one ripple."""
    q = motion()[0]
    numbers = np.array([[4.0, 2.0, 6.0], [5.0, 0.0, 0.0]])
    sizes = np.array([[0.12, 0.07, 0.05], [0.1, 0.0, 0.0]])
    waves = sizes[:, None] * np.sin(2.0 * np.pi * numbers[:, None] * q[:, :, None] + 0.7)
    found = Ripples.of(rows(waves.sum(axis=2)))
    assert pytest.approx(numbers, abs=0.04) == found.cycles.T


def test_noise_has_one_at_most() -> None:
    assert len(Ripples.of(rows()).cycles) == 1


def test_the_low_pass_leaves_what_its_gain_says() -> None:
    """At a constant speed the ripple is a sine in time, of which scipy knows the gain."""
    for frequency in (2.0, 6.0, 9.0):
        t = np.arange(4000) * H
        wave = np.sin(2.0 * np.pi * frequency * t)
        passed = sosfiltfilt(butter(4, CUTOFF, fs=1.0 / H, output="sos"), wave)[1000:3000]
        left = float(gain(rows(), np.array(frequency)))
        assert left == pytest.approx(np.sqrt(2.0 * np.mean(passed**2)), rel=0.01)


def test_a_joint_that_stands_still_has_none() -> None:
    still = rows()
    still.motion[:2, 1] = 0.0
    assert np.all(Ripples.of(still).cycles[:, 1] == 0.0)
