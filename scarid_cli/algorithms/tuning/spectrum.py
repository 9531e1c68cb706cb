"""The bandwidth of a signal, and of the motion of a record, from spectra."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from scarid_cli.algorithms.processes.resolution import resolution_of
from scarid_cli.algorithms.tuning.lowpassed import Segment
from scarid_cli.arrays import Array

POWER = 0.95  # of the power of the velocity lies below the bandwidth of a motion
ABOVE = 10.0  # times the noise's density, from which on the density is that of the motion


def bandwidths(segments: Sequence[Segment], h: float) -> tuple[Array, Array]:
    """Those of the velocities and of the torques (joints) [Hz] in the longest segment; h [s].

    If several are as long, as the blocks of a long log are, their densities are averaged.
    """
    length = max(segment.q.shape[1] for segment in segments)
    longest = [segment for segment in segments if segment.q.shape[1] == length]
    q, tau = (zip(*x, strict=True) for x in ([s.q for s in longest], [s.tau for s in longest]))
    velocities = np.array([bandwidth(np.stack(x), h, derivative=1) for x in q])
    return velocities, np.array([bandwidth(np.stack(x), h, derivative=0) for x in tau])


def bandwidth(x: Array, h: float, derivative: int) -> float:
    """The frequency [Hz] below which POWER of a signal's (or its derivative's) power lies.

    x (rows, or records and rows) is sampled every h [s]. Frequencies at which the density does not
    exceed that of white noise, found from the highest quarter of all frequencies, do not count. Nor
    do those above which there is no more power than rounding to the resolution of x may cause, an
    error of up to half a step: that of an encoder that is read often has tones. 0 for a signal at
    rest.
    """
    x = np.atleast_2d(x)
    rows = x.shape[1]
    trend, window = np.linspace(x[:, 0], x[:, -1], rows, axis=1), np.hanning(rows)
    density = np.mean(np.abs(np.fft.rfft((x - trend) * window)) ** 2, axis=0)
    floor = density[-(len(density) // 4) :].mean()
    above = np.cumsum(density[::-1])[::-1] * 2.0 / (rows * np.sum(window**2))
    signal = (density > ABOVE * floor) & (above > (0.5 * resolution_of(x[0])) ** 2)
    frequency = np.fft.rfftfreq(rows, h)
    power = np.where(signal, density, 0.0) * frequency ** (2 * derivative)
    total = np.cumsum(power)
    if not total[-1] > 0.0:
        return 0.0
    return float(frequency[int(np.searchsorted(total, POWER * total[-1]))])
