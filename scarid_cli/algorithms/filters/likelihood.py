"""Settings of the Kalman methods from the data alone: maximum likelihood and cross-validation.

See docs/theory.md, section "Maximum likelihood and cross-validation".
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np

from scarid_cli.algorithms.filters.kalman import Model, filtered, recorded, smoothed
from scarid_cli.algorithms.filters.kalman_method import STATES, KalmanMethod
from scarid_cli.algorithms.processes.resolution import resolution_of
from scarid_cli.arrays import Array
from scarid_cli.errors import TooShort

K = TypeVar("K", bound=KalmanMethod)

ENOUGH = 20_000  # rows
PULSE_ROWS = 4001  # rows that a pulse may act on
DIFFERENCES = 6  # order of the differences of positions that leave the noise and not the motion
FITTED = ("noise", "intensity", "damping", "frequency")  # the last two for a damped process
# The first innovations determine the states, and the others must outnumber the settings; and the
# starting value of the noise needs differences.
FEWEST_ROWS = max(STATES[-1] + len(FITTED), DIFFERENCES) + 1


def noise_of(x: Array) -> float:
    """Standard deviation of the white noise on a smooth signal, from its differences of high order.

    Never less than 1e-9 of the range of x, so that a signal without noise does not give 0.
    """
    gain = np.sqrt(np.sum(np.poly(np.ones(DIFFERENCES)) ** 2))
    floor = 1e-9 * (np.ptp(x) or 1.0)
    if len(x) <= DIFFERENCES:
        return float(floor)
    return float(max(np.sqrt(np.mean(np.diff(x, DIFFERENCES) ** 2)) / gain, floor))


def noise_floor(records: Sequence[Array]) -> float:
    """The root mean square over the records of the noise that their resolution alone makes."""
    resolutions = np.array([resolution_of(x) for x in records])
    return float(np.sqrt(np.mean(resolutions**2) / 12.0))


def log_likelihood(method: KalmanMethod, x: Array, h: float) -> float:
    """The logarithm of the likelihood of the positions x, up to a constant per sample.

    A glitch counts as much as an innovation that the gate just lets pass.
    """
    state, _ = filtered(method.model(h).at_rest(float(x[0])), x)
    return state.likelihood


def best_model(method: K, x: Array, h: float) -> K:
    """The method with states, noise, intensity and acceleration process of the positions x.

    x: of one joint (rows), or of several that share the settings (joints, rows); sampled every
    h [s]. Of the chains of 3 to 5 states and the damped ones, the model is the most likely, less
    one for each further setting (Akaike's criterion). A long record is represented by its first
    rows.
    """
    records = [np.ascontiguousarray(row[:ENOUGH]) for row in np.atleast_2d(x)]
    if len(records[0]) < FEWEST_ROWS:
        raise TooShort(
            f"{len(records[0])} rows are too few to find the noise and the model of the motion; "
            f"give a log of at least {FEWEST_ROWS} rows"
        )
    found: list[tuple[float, K]] = []
    for states in STATES:
        plain = replace(method, states=states, damping=0.0, frequency=0.0)
        chain = most_likely(plain, records, h)
        found.append((likelihood_of_all(chain, records, h), chain))
        if states > STATES[0]:
            damped = most_likely(chain, records, h, damped=True)
            found.append((likelihood_of_all(damped, records, h) - 2.0, damped))
    return max(found, key=lambda pair: pair[0])[1]


def likelihood_of_all(method: KalmanMethod, records: Sequence[Array], h: float) -> float:
    """The logarithm of the likelihood of several independent records with the same settings."""
    return sum(log_likelihood(method, x, h) for x in records)


def most_likely(method: K, records: Sequence[Array], h: float, *, damped: bool = False) -> K:
    """The method with the noise and the intensity that make the records (of positions) most likely.

    The noise is at least that of the encoder's resolution. With `damped`, also with the damping and
    the frequency of the acceleration process, starting from a method that is the most likely one
    without. The search is a grid, then the simplex of Nelder and Mead on logarithms.
    """
    from scipy.optimize import minimize

    floor = noise_floor(records)

    def at(point: Array) -> K:
        settings = dict(zip(FITTED[: len(point)], np.exp(point), strict=True))
        return replace(method, **{**settings, "noise": max(settings["noise"], floor)})

    def loss(point: Array) -> float:
        if np.abs(point).max() > 60.0:
            return np.inf
        with np.errstate(all="ignore"):  # the model of an absurd damping overflows
            value = -likelihood_of_all(at(point), records, h)
        return value if np.isfinite(value) else np.inf

    if damped:
        start = np.log([method.noise, method.intensity, 1.0, 2.0])
    else:
        # Of one variance for all records, the most likely value is the mean of theirs.
        sigma = max(np.sqrt(np.mean([noise_of(x) ** 2 for x in records])), floor)
        # The intensity that goes with a bandwidth [rad/s] at this noise
        bandwidths = np.geomspace(2.0, 1.5 / h, 25)
        grid = 2 * method.states * np.log(bandwidths) + np.log(sigma**2 * h)
        starts = (np.array([np.log(sigma), intensity]) for intensity in grid)
        start = min(starts, key=loss)
    options = {"xatol": 1e-3, "fatol": 1e-3, "maxfev": 600}
    return at(minimize(loss, start, method="Nelder-Mead", options=options).x)


def best_smoothing(method: K, x: Array, h: float) -> K:
    """The method with the intensity whose smoother predicts held-out positions of x best.

    x: of one joint (rows), or of several that share the settings (joints, rows). The likelihood
    looks one sample ahead. A smoother sees the motion on both sides, and on a smooth motion does
    better with a lower intensity. The search is a grid of half decades, then the minimum of the
    parabola through its least points.
    """
    records = [np.ascontiguousarray(row[:ENOUGH]) for row in np.atleast_2d(x)]
    grid = np.log(method.intensity) + np.log(10.0) * np.arange(-6.0, 1.5, 0.5)

    def at(log_intensity: float) -> K:
        return replace(method, intensity=float(np.exp(log_intensity)))

    tiny = np.finfo(float).tiny  # of a record at rest
    errors = np.array(
        [sum(np.log(held_out_error(at(g), row, h) + tiny) for row in records) for g in grid]
    )
    least = int(np.argmin(errors))
    around = errors[max(least - 1, 0) : least + 2]
    if len(around) < 3 or not np.isfinite(around).all():
        return at(grid[least])
    left, here, right = around
    shift = 0.5 * (left - right) / (left - 2.0 * here + right)
    return at(grid[least] + shift * (grid[1] - grid[0]))


def held_out_error(method: KalmanMethod, x: Array, h: float) -> float:
    """Mean squared error of positions predicted from all others, by cross-validation.

    Generalised cross-validation (Craven and Wahba, Numer. Math. 31 (1979) 377): the residual of a
    linear smoother over one less the weight of the sample itself. A glitch counts as much as the
    gate lets pass.
    """
    model = method.model(h)
    residual = x - smoothed_position(model, x)
    pulse = np.zeros(PULSE_ROWS)
    pulse[PULSE_ROWS // 2] = method.noise  # below every gate
    weight = smoothed_position(model, pulse)[PULSE_ROWS // 2] / method.noise
    squares = np.minimum(residual**2, (method.gate * method.noise) ** 2)
    edge = len(x) // 20
    free = 1.0 - float(weight)
    # A smoother that only repeats its samples predicts none of them.
    return float(np.mean(squares[edge : len(x) - edge])) / free**2 if free > 0.0 else np.inf


def smoothed_position(model: Model, x: Array) -> Array:
    """The positions x, smoothed."""
    state, records = recorded(model.at_rest(float(x[0])), x)
    return smoothed(records, state)[:, 0]
