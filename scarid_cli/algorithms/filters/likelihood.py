"""Settings of the Kalman differentiators by maximum likelihood: from the data alone."""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar

import numpy as np

from scarid_cli.algorithms.filters.kalman import Settings, filtered
from scarid_cli.arrays import Array

S = TypeVar("S", bound=Settings)

DIFFERENCES = 6  # of positions: the motion is gone from them, the noise is not


def noise_of(x: Array) -> float:
    """Standard deviation of white noise on a smooth signal, from its differences of high order."""
    gain = np.sqrt(np.sum(np.poly(np.ones(DIFFERENCES)) ** 2))
    floor = 1e-9 * (np.ptp(x) or 1.0)  # a signal without any noise
    if len(x) <= DIFFERENCES:
        return float(floor)
    return float(max(np.sqrt(np.mean(np.diff(x, DIFFERENCES) ** 2)) / gain, floor))


def log_likelihood(settings: Settings, x: Array, h: float) -> float:
    """Of the samples x, but for a constant; glitches count as much as the gate lets them."""
    state, _ = filtered(settings.model(h).at_rest(float(x[0])), x)
    return state.likelihood


def most_likely(settings: S, x: Array, h: float, *, oscillator: bool = False) -> S:
    """The settings with the noise and the intensity that make x most likely.

    With `oscillator` also the damping and the frequency of the acceleration process. A grid, then
    the simplex of Nelder and Mead on the logarithms.
    """
    from scipy.optimize import minimize

    x = np.ascontiguousarray(x)
    sigma = noise_of(x)

    def at(point: Array) -> S:
        names = ("noise", "intensity", "damping", "frequency")[: len(point)]
        return replace(settings, **dict(zip(names, np.exp(point), strict=True)))

    def loss(point: Array) -> float:
        if np.abs(point).max() > 60.0:
            return np.inf
        value = -log_likelihood(at(point), x, h)
        return value if np.isfinite(value) else np.inf

    # The intensity that goes with a bandwidth [rad/s] at this noise
    bandwidths = np.geomspace(2.0, 1.5 / h, 25)
    grid = 2 * settings.states * np.log(bandwidths) + np.log(sigma**2 * h)
    starts = (np.array([np.log(sigma), intensity]) for intensity in grid)
    options = {"xatol": 1e-3, "fatol": 1e-3, "maxfev": 600}
    chain = minimize(loss, min(starts, key=loss), method="Nelder-Mead", options=options)
    if not oscillator:
        return at(chain.x)
    start = np.concatenate((chain.x, np.log([1.0, 2.0])))
    damped = minimize(loss, start, method="Nelder-Mead", options=options)
    return at(damped.x) if damped.fun < chain.fun - 2.0 else at(chain.x)
