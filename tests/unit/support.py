"""What several unit tests share: cuts into chunks, motions with known derivatives, robots."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
from hypothesis import strategies as st

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.arrays import Array

PERIOD = 0.005


def cuts(rows: int) -> st.SearchStrategy[list[slice]]:
    """Ways to cut rows into chunks: anywhere, all single rows, or not at all."""
    anywhere = st.lists(st.integers(1, rows - 1), max_size=6, unique=True).map(sorted)
    inner = st.one_of(anywhere, st.sampled_from([[], list(range(1, rows))]))
    return inner.map(lambda at: [slice(a, b) for a, b in pairwise([0, *at, rows])])


def sine(samples: int, amplitude: float = 0.5, omega: float = 1.0) -> tuple[Array, Array, Array]:
    """A motion sampled every PERIOD, and its exact derivatives."""
    t = PERIOD * np.arange(samples)
    q = amplitude * np.sin(omega * t)
    return q, amplitude * omega * np.cos(omega * t), -(omega**2) * q


def encoder_readings(samples: int, bits: int = 13) -> Array:
    """A motion as an encoder sees it."""
    resolution = 2.0 * np.pi / 2**bits
    return resolution * np.round(sine(samples, omega=3.0)[0] / resolution)


def derivatives(
    method: Any, q: Array, chunks: list[slice] | None = None, h: float = PERIOD
) -> tuple[Array, Array]:
    """Velocity and acceleration of a whole record, stepped chunk by chunk."""
    state = method.init(float(q[0]), h)
    parts = []
    for chunk in chunks or [slice(0, len(q))]:
        state, part = method.step(state, q[chunk])
        parts.append(part)
    parts.append(method.finish(state))
    v, a = (np.concatenate(rows) for rows in zip(*filter(None, parts), strict=True))
    return v, a


# For methods that would search each record for their settings, which takes most of a second.
GIVEN = {"rts": {"noise": 1e-4, "intensity": 1e3}}


def without_search(name: str) -> Any:
    """A method with its defaults, or with given settings where these make it search the record."""
    return DIFFERENTIATORS.load(name)(**GIVEN.get(name, {}))


def every_differentiator() -> Iterator[tuple[str, Callable[[], Any]]]:
    """Each method as it comes, and with each of its presets: a name and how to make it."""
    for name in DIFFERENTIATORS.names:
        method = DIFFERENTIATORS.load(name)
        yield name, method
        for preset, settings in method.PRESETS.items():
            yield f"{name} {preset}", lambda method=method, settings=settings: method(**settings)


def adjusted(name: str, **values: float) -> Robot:
    """A built-in robot with other a priori values, and no limit on its torques."""
    robot = load(name)
    unknown = values.keys() - set(robot.names)
    assert not unknown, f"{name} has no {unknown}"
    return replace(
        robot,
        joints=tuple(replace(joint, torque_limit=np.inf) for joint in robot.joints),
        parameters=tuple(
            replace(p, apriori=values.get(p.name, p.apriori)) for p in robot.parameters
        ),
    )
