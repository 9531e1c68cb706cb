"""The bandwidth of the low-pass that a matched differentiator is, and the noise that passes it."""

from __future__ import annotations

from functools import lru_cache
from math import pi, sqrt

import numpy as np

from scarid_cli.algorithms.processes.matching import over, settling_rows
from scarid_cli.algorithms.processes.method import Matching, Method
from scarid_cli.algorithms.processes.process import Process

HALF_POWER = np.sqrt(0.5)  # -3 dB
FINENESS = 16  # points of the spectrum for each that the pulse response has by itself
POINTS = 1 << 21  # of the spectrum, of which longer responses have fewer for each of their own
LINEAR = (Matching.EXACT, Matching.SECOND_ORDER, Matching.LINEARISED)


def bandwidth_of(method: Method, h: float) -> float | None:
    """The frequency [Hz] at which a matched method passes half the power of torques, at period h.

    None if the method leaves torques as they are, delays them only, or has yet to tune itself.
    """
    if method.MATCHING not in LINEAR:
        return None
    torque_filter = method.matched().torque_filter
    return None if torque_filter is None else lowpass_bandwidth(torque_filter, h)


@lru_cache(maxsize=64)  # processes are frozen dataclasses; the joints often have the same one
def lowpass_bandwidth(process: Process, h: float) -> float:
    """The -3 dB frequency [Hz] of a linear low-pass sampled every h [s], from its pulse response.

    It is half the sampling rate if the process passes everything.
    """
    half = 8 + 4 * sum(settling_rows(process, h))
    pulse = np.zeros(2 * half)
    pulse[half] = 1.0
    points = len(pulse) * min(max(POINTS // len(pulse), 1), FINENESS)
    gain = np.abs(np.fft.rfft(over(process, pulse, h)[0], points))
    below = np.flatnonzero(gain < HALF_POWER * gain[0])
    if not len(below):
        return 0.5 / h
    k = int(below[0])
    share = (gain[k - 1] - HALF_POWER * gain[0]) / (gain[k - 1] - gain[k])
    return float((k - 1 + share) / (points * h))


def velocity_noise(noise: float, bandwidth: float, h: float) -> float:
    """The standard deviation of the velocity behind a low-pass, from the position's.

    noise: white, of the position [rad or m]; bandwidth [Hz], taken as that of an ideal low-pass;
    h [s]. The spectral density 2 noise^2 h of the position, times (2 pi f)^2, integrated up to the
    bandwidth.
    """
    return noise * sqrt(8.0 * pi**2 * h * bandwidth**3 / 3.0)


def acceleration_noise(noise: float, bandwidth: float, h: float) -> float:
    """The standard deviation of the acceleration behind a low-pass; see `velocity_noise`."""
    return noise * sqrt(32.0 * pi**4 * h * bandwidth**5 / 5.0)
