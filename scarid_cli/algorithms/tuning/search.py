"""Search for the settings of a differentiator that a judge likes best."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from scarid_cli.algorithms.choices.ranges import Range
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault

LATTICE_POINTS = 16  # where a search starts, before the simplex


@dataclass(frozen=True)
class Trial:
    """A method with settings that were tried, and the loss its judge found: less is better."""

    method: Any
    loss: float


Judge = Callable[[Any], float]


def search(
    method: Any, ranges: dict[str, Range], judge: Judge, h: float, seed: int
) -> Iterator[Trial]:
    """All trials: the method as it is, guesses over the ranges, and the simplex of Nelder and Mead.

    h: sampling period [s].
    """
    from scipy.optimize import minimize

    trials: dict[Any, float] = {}

    def loss(x: Array) -> float:
        settings = {name: r.setting(u, h) for (name, r), u in zip(ranges.items(), x, strict=True)}
        try:
            tried = replace(method, **settings)
            if tried not in trials:
                trials[tried] = judge(tried)
        except UsageFault:
            return 1e9  # settings that the sampling rate does not allow
        value = trials[tried] + np.sum((x - np.clip(x, 0.0, 1.0)) ** 2)
        return float(value) if np.isfinite(value) else 1e9

    trials[method] = judge(method)
    yield Trial(method, trials[method])
    if not ranges:
        return
    # A scrambled lattice: as even in one dimension as in three
    rng = np.random.default_rng(seed)
    lattice = (np.arange(LATTICE_POINTS) + 0.5) / LATTICE_POINTS
    guesses = np.column_stack([rng.permutation(lattice) for _ in ranges])
    best = min(guesses, key=loss)
    options = {"xatol": 2e-3, "fatol": 1e-6, "maxfev": 60 * len(ranges)}
    corners = np.vstack([best, *(best + 0.08 * row for row in np.eye(len(ranges)))])
    minimize(loss, best, method="Nelder-Mead", options={**options, "initial_simplex": corners})
    yield from (Trial(tried, value) for tried, value in trials.items() if tried != method)
