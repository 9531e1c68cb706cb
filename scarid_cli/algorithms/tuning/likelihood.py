"""Settings of the Kalman differentiators by maximum likelihood: from the data alone."""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar

import numpy as np

from scarid_cli.algorithms.filters.kalman import Model, Settings, filtered, recorded, smoothed
from scarid_cli.arrays import Array

S = TypeVar("S", bound=Settings)

ENOUGH = 20_000  # rows
REACH = 4001  # rows that a pulse may act on
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


def best_model(settings: S, x: Array, h: float) -> S:
    """The settings with the states, the noise, the intensity and the acceleration process of x.

    Of the chains of 3 to 5 states and the damped ones, the most likely, less one for each setting
    it needs more (Akaike). From the first rows of a long record.
    """
    x = np.ascontiguousarray(x[:ENOUGH])
    found: list[tuple[float, S]] = []
    for states in (3, 4, 5):
        plain = replace(settings, states=states, damping=0.0, frequency=0.0)
        chain = most_likely(plain, x, h)
        found.append((log_likelihood(chain, x, h), chain))
        if states > 3:
            damped = most_likely(chain, x, h, damped=True)
            found.append((log_likelihood(damped, x, h) - 2.0, damped))
    return max(found, key=lambda pair: pair[0])[1]


def most_likely(settings: S, x: Array, h: float, *, damped: bool = False) -> S:
    """The settings with the noise and the intensity that make x most likely.

    With `damped` also the damping and the frequency of the acceleration process, from settings
    that are the most likely without. A grid, then the simplex of Nelder and Mead on logarithms.
    """
    from scipy.optimize import minimize

    x = np.ascontiguousarray(x)

    def at(point: Array) -> S:
        names = ("noise", "intensity", "damping", "frequency")[: len(point)]
        return replace(settings, **dict(zip(names, np.exp(point), strict=True)))

    def loss(point: Array) -> float:
        if np.abs(point).max() > 60.0:
            return np.inf
        value = -log_likelihood(at(point), x, h)
        return value if np.isfinite(value) else np.inf

    if damped:
        start = np.log([settings.noise, settings.intensity, 1.0, 2.0])
    else:
        sigma = noise_of(x)
        # The intensity that goes with a bandwidth [rad/s] at this noise
        bandwidths = np.geomspace(2.0, 1.5 / h, 25)
        grid = 2 * settings.states * np.log(bandwidths) + np.log(sigma**2 * h)
        starts = (np.array([np.log(sigma), intensity]) for intensity in grid)
        start = min(starts, key=loss)
    options = {"xatol": 1e-3, "fatol": 1e-3, "maxfev": 600}
    return at(minimize(loss, start, method="Nelder-Mead", options=options).x)


def best_smoothing(settings: S, x: Array, h: float) -> S:
    """The settings with the intensity whose smoother predicts held-out positions best.

    The likelihood looks one sample ahead; a smoother sees the motion on both sides, and on a smooth
    one does better with less. A grid of half decades, then the parabola through its least points.
    """
    x = np.ascontiguousarray(x[:ENOUGH])
    grid = np.log(settings.intensity) + np.log(10.0) * np.arange(-6.0, 1.5, 0.5)

    def at(log_intensity: float) -> S:
        return replace(settings, intensity=float(np.exp(log_intensity)))

    tiny = np.finfo(float).tiny  # of a record at rest
    errors = np.log([held_out_error(at(point), x, h) + tiny for point in grid])
    least = int(np.argmin(errors))
    around = errors[max(least - 1, 0) : least + 2]
    if len(around) < 3 or not np.isfinite(around).all():
        return at(grid[least])
    left, here, right = around
    shift = 0.5 * (left - right) / (left - 2.0 * here + right)
    return at(grid[least] + shift * (grid[1] - grid[0]))


def held_out_error(settings: Settings, x: Array, h: float) -> float:
    """Mean square error of positions predicted from all others: generalised cross-validation.

    The residual of a linear smoother over one less the weight of the sample itself; glitches
    count as much as the gate lets them.
    """
    model = settings.model(h)
    residual = x - position(model, x)
    pulse = np.zeros(REACH)
    pulse[REACH // 2] = settings.noise  # below every gate
    weight = position(model, pulse)[REACH // 2] / settings.noise
    squares = np.minimum(residual**2, (settings.gate * settings.noise) ** 2)
    edge = len(x) // 20
    free = 1.0 - float(weight)
    # A smoother that only repeats its samples predicts none of them.
    return float(np.mean(squares[edge : len(x) - edge])) / free**2 if free > 0.0 else np.inf


def position(model: Model, x: Array) -> Array:
    """The smoothed position."""
    state, records = recorded(model.at_rest(float(x[0])), x)
    return smoothed(records, state)[:, 0]
