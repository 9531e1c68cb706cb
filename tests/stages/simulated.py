"""Logs of a simulated robot with imperfections."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any

import numpy as np
from stages.tables import SCARA, collected, references, table

from scarid_cli.algorithms.imperfections.registry import Imperfections, values_of
from scarid_cli.algorithms.plants import building
from scarid_cli.algorithms.plants.controllers import law
from scarid_cli.algorithms.plants.loop import ClosedLoop
from scarid_cli.arrays import Array
from scarid_cli.io.table import Table
from scarid_cli.stages.simulate import simulate

QUIET = {"encoder-bits": [0], "torque-noise": [0]}
Values = Mapping[str, Sequence[float | str]]


def simulated(source: Table, values: Values, rate: float, seed: int = 3) -> Table:
    joints = len(SCARA.joints)
    found = {name: values_of(name, given, joints) for name, given in values.items()}
    imperfections = Imperfections(joints, found)
    loop = closed_loop(imperfections, seed)
    return simulate(source, loop, rate, truth=True, given=imperfections)


def closed_loop(imperfections: Imperfections, seed: int) -> ClosedLoop:
    return ClosedLoop(
        SCARA,
        law=law(SCARA),
        seed=seed,
        **building.in_the_loop(imperfections, SCARA.joints, 1000.0),
    )


@cache
def _log(rate: float, *values: Any) -> dict[str, Array]:
    result = collected(simulated(table(references()), {k: list(v) for k, v in values}, rate))
    return {name: result.column(name).to_numpy() for name in result.column_names}


def log(rate: float = 200.0, values: Values | None = None) -> dict[str, Array]:
    """The columns of the log of two seconds, at a rate [Hz], of the robot with these values."""
    return _log(rate, *((name, tuple(given)) for name, given in (values or {}).items()))


def signals(columns: dict[str, Array], name: str) -> Array:
    return np.array([columns[name.format(i=i)] for i in (1, 2)])


LOG_LEVEL = {
    "position-delay": [0.0023],
    "position-rate": [125.0],
    "position-outliers": [0.1],
    "position-outlier-size": [0.5],
    "torque-constant-error": [0.1, -0.2],
    "torque-offset": [1.0, -2.0],
    "torque-bandwidth": [30.0],
    "torque-delay": [0.0017],
    "torque-rate": [90.0],
    "coloured-torque-noise": [0.5],
    "torque-noise-time": [0.05],
    "torque-resolution": [0.25],
    "torque-outliers": [0.1],
    "torque-outlier-size": [10.0],
    "repeated-rows": [0.2],
    "stamp-jitter": [1e-4],
}
