"""Differentiators of other packages, tuned without the truth, by their own tuner if they have one.

A sensor takes positions and returns velocities and accelerations. PyNumDiff has first derivatives
only: for the acceleration, its method is applied to its own velocity, or numpy's gradient is taken,
whichever gives the smaller error.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from functools import partial
from importlib import import_module
from typing import Any

import numpy as np
from signals import Derivatives, H, Sensor

from scarid_cli.algorithms.choices.ranges import Range
from scarid_cli.algorithms.tuning import judges
from scarid_cli.arrays import Array

BAND = 1.0  # Hz, bandwidth of the motion that PyNumDiff is given
# Its searches over all settings take minutes to hours each: here the usual order, and few starts.
SPACES: dict[str, tuple[str, dict[str, Any]]] = {
    "rtsdiff": ("kalman_smooth", {"order": 3, "forwardbackward": False,
                                  "log_qr_ratio": [5.0, 9.0, 12.0, 16.0]}),
    "splinediff": ("polynomial_fit", {"degree": 5}),
    "tvrdiff": ("total_variation_regularization", {"order": 3, "huberM": 6.0,
                                                   "gamma": [10.0]}),
    "butterdiff": ("smooth_finite_difference", {"filter_order": 4, "num_iterations": 1}),
    "savgoldiff": ("polynomial_fit", {"degree": 5, "window_size": [31, 91, 201],
                                      "smoothing_win": [3, 31]}),
    "spectraldiff": ("basis_fit", {"extension": "even", "pad_to_flat": True}),
}  # fmt: skip
# A solution takes ten seconds: tuned on five seconds of the record, and not applied twice.
SLOW = {"tvrdiff"}
ITERATIVE = ("rtsdiff", "splinediff", "tvrdiff")


def present() -> dict[str, bool]:
    """Which of the packages can be imported."""
    found = {}
    for name in ("pynumdiff", "AlgDiff", "derivative"):
        try:
            import_module(name)
            found[name] = True
        except ImportError:
            found[name] = False
    return found


def pynumdiff(name: str, q: Array) -> tuple[Sensor, ...]:
    """The method as its `optimize` tunes it on these positions: applied twice, or with gradient."""
    from pynumdiff.optimize import optimize

    module, space = SPACES[name]
    method = getattr(import_module(f"pynumdiff.{module}"), name)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        part, rounds = (q[:1000], 5) if name in SLOW else (q, 10)
        options = {"parallel": False, "padding": "auto", "maxiter": rounds}
        settings, _ = optimize(
            method, part, H, bandlimit=BAND, search_space_updates=space, **options
        )

    def velocity(x: Array) -> Array:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return np.asarray(method(x, H, **settings)[1])

    gradient = partial(_completed, velocity, lambda v: np.gradient(v, H))
    return (gradient,) if name in SLOW else (partial(_completed, velocity, velocity), gradient)


def _completed(
    velocity: Callable[[Array], Array], acceleration: Callable[[Array], Array], x: Array
) -> Derivatives:
    """Both derivatives, from one that takes positions and one that takes velocities."""
    v = velocity(x)
    return v, acceleration(v)


def derivative(name: str, settings: dict[str, float]) -> Sensor:
    """A method of the package `derivative`, applied twice; the package has no tuner."""
    from derivative import dxdt

    def run(x: Array) -> Derivatives:
        t = np.arange(len(x)) * H
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            v = dxdt(x, t, kind=name, **settings)
            return np.asarray(v), np.asarray(dxdt(v, t, kind=name, **settings))

    return run


DERIVATIVE: dict[str, tuple[str, dict[str, float]]] = {
    "derivative Spline": ("spline", {"s": 1e-2, "order": 5}),
    "derivative Kalman": ("kalman", {"alpha": 1e-3}),  # its cost is cubic in the rows
    "derivative SavGol": ("savitzky_golay", {"left": 0.2, "right": 0.2, "order": 5}),
}


def algdiff(window: float) -> Sensor:
    """AlgDiff of degree 0 with alpha = beta = 4, as in its examples; causal, not shifted."""
    from AlgDiff import AlgebraicDifferentiator

    toolbox = AlgebraicDifferentiator(
        ts=H, alpha=4.0, beta=4.0, N=0, T=round(window / H) * H, display=False, corr=True
    )
    taps = [
        np.ravel(toolbox.discretize(order, method="mid-point")[order]["mid-point"])
        for order in (1, 2)
    ]

    def run(x: Array) -> Derivatives:
        padded = [np.concatenate((np.full(len(t) - 1, x[0]), x)) for t in taps]
        v, a = (np.convolve(p, t, "valid") for p, t in zip(padded, taps, strict=True))
        return v, a

    return run


def tuned_algdiff(q: Array) -> Sensor:
    """AlgDiff with the window that the criterion of `scarid tune` chooses; it has no tuner."""
    window = Range(0.03, 0.5)
    smooth = _smooth(q)
    inner = slice(200, -200)

    def loss(sensor: Sensor) -> float:
        return float(
            np.prod([np.std((x - y)[inner]) for x, y in zip(sensor(q), smooth, strict=True)])
        )

    sensors = [algdiff(window.setting(x, H)) for x in np.linspace(0.0, 1.0, 25)]
    return min(sensors, key=loss)


def _smooth(q: Array) -> Derivatives:
    from scarid_cli.algorithms.processes.matching import over

    _, v, a = over(judges.smoother(q, H).matched(), q, H)
    return v, a


def shifted(sensor: Sensor, q: Array) -> Sensor:
    """Both derivatives, advanced by their delay relative to those of a smoother."""
    from scarid_cli.algorithms.processes.delays import lateness

    late = [round(lateness(x, y, H) / H) for x, y in zip(sensor(q), _smooth(q), strict=True)]
    return partial(_advanced, sensor, late)


def _advanced(sensor: Sensor, late: list[int], q: Array) -> Derivatives:
    v, a = (
        np.concatenate((x[n:], np.full(n, x[-1]))) for x, n in zip(sensor(q), late, strict=True)
    )
    return v, a
