"""Arguments for every function of every kernel: the cases that the tests of the kernels run."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from speed import interpreted

from scarid_cli.algorithms.differentiators.kalman import Differentiator as Kalman
from scarid_cli.algorithms.filters.butterworth import Butterworth
from scarid_cli.algorithms.filters.kalman import Records
from scarid_cli.algorithms.plants.model import model
from scarid_cli.algorithms.robots.reading import load

Arguments = list[Any]


def motion(rng: np.random.Generator, samples: int = 400) -> np.ndarray:
    """A random walk in steps of a 13-bit encoder: equal neighbours do occur."""
    return 2.0 * np.pi / 2**13 * np.cumsum(rng.integers(-3, 4, samples)).astype(float)


def p2smd(rng: np.random.Generator) -> Arguments:
    q = motion(rng)
    gains = np.array([25.0, 20.0, 0.1, 0.0, 2.0, 1.0])
    return [q, np.empty_like(q), np.empty_like(q), rng.random(6), gains, 0.005]


def p2smd_literal(rng: np.random.Generator) -> Arguments:
    arguments = p2smd(rng)
    arguments[4] = np.array([25.0, 20.0, 0.0, -np.inf, np.inf, np.inf])
    return arguments


def smd2(rng: np.random.Generator) -> Arguments:
    q = motion(rng)
    return [q, np.empty_like(q), np.empty_like(q), rng.random(3), 10.0 * rng.random(3), 0.005]


def astd(rng: np.random.Generator) -> Arguments:
    q = motion(rng)
    gains = np.array([1.0, 50.0, 0.1, 0.0015, 0.01])
    return [q, np.empty_like(q), rng.random(3), gains, 0.005]


def levant(rng: np.random.Generator, filters: int = 0, taylor: int = 1) -> Arguments:
    q = motion(rng)
    state, gains = rng.random(5), 10.0 * rng.random(5)
    return [q, np.empty_like(q), np.empty_like(q), state, gains, filters, taylor, 0.005]


def implicit_levant(rng: np.random.Generator, order: int = 3) -> Arguments:
    q = motion(rng)
    gains = 10.0 * rng.random(order + 1)
    return [q, np.empty_like(q), np.empty_like(q), rng.random(order + 1), gains, 0.005]


def tracking(rng: np.random.Generator) -> Arguments:
    q = motion(rng)
    return [q, np.empty_like(q), np.empty_like(q), rng.random(2), np.array([30.0, 0.02]), 0.005]


def aise(rng: np.random.Generator, order: int = 2) -> Arguments:
    q, size, window = motion(rng), 2 * order + 1, 7
    return [
        *(q, np.empty_like(q), np.empty_like(q)),
        rng.random(8),
        rng.standard_normal(size),
        1e6 * np.eye(size),
        1e-3 * rng.standard_normal((2, order + window + 1)),
        rng.random((window + 1, 2)),
        np.empty((3, size)),
        np.array([1e-10, 1e-4, 0.5, 1e-7]),
        0.005,
    ]


def kalman(rng: np.random.Generator) -> Arguments:
    """A glitch now and then, and a step that stays."""
    q = motion(rng)
    q[::50] += 1.0
    q[300:] += 0.5
    state = Kalman().model(0.005).at_rest(float(q[0]))
    return [q, np.empty((400, 4)), *state.arrays, *state.model.arrays]


def kalman_records(rng: np.random.Generator) -> Arguments:
    q, _, *rest = kalman(rng)
    records = [np.zeros_like(array) for array in Records.of(400, 4).arrays]
    return [q, *records, *rest]


def smoothing(rng: np.random.Generator) -> Arguments:
    """The records of a filter whose gain settles, glitches included."""
    q, *records, x, P, gain, work, F, Q, noise = kalman_records(rng)
    interpreted("kalman").recorded(q, *records, x, P, gain, work, F, Q, noise)
    return [*records, P, F]


def lagged(rng: np.random.Generator) -> Arguments:
    return [*smoothing(rng), rng.standard_normal((2, 8)), np.empty((395, 2)), np.empty(8)]


def smoothed(rng: np.random.Generator) -> Arguments:
    return [*smoothing(rng), np.empty((400, 3)), np.empty(8)]


def fir(rng: np.random.Generator) -> Arguments:
    q = motion(rng)
    return [q, np.empty(len(q) - 10), rng.standard_normal(11)]


def sos(rng: np.random.Generator) -> Arguments:
    q = motion(rng)
    sections = Butterworth(8.0, order=5).sections(0.005)
    return [q, np.empty_like(q), rng.standard_normal((3, 2)), sections]


def information(
    rng: np.random.Generator,
    forgetting: float | tuple[float, ...] = 1.0,
    *,
    trace: bool = False,
    weights: bool = False,
) -> Arguments:
    samples, joints, p = 60, 2, 5
    W = rng.standard_normal((samples, joints, p))
    W[rng.random(W.shape) < 0.3] = 0.0  # a regressor is full of them
    y = rng.standard_normal((samples, joints))
    scales = rng.integers(0, 3, (samples, joints)) / 2.0
    triangle = np.column_stack((0.1 * np.eye(p), rng.standard_normal(p)))
    estimates = np.empty((samples if trace else 0, p))
    factors = np.resize(forgetting, p).astype(float)
    residuals = np.zeros((joints if weights else 0, 4))
    work, sums = np.empty(p + 1), rng.random(3)
    return [W, y, scales, triangle, work, sums, estimates, factors, 0.05, residuals, 2.0]


def moments(rng: np.random.Generator) -> Arguments:
    return [rng.standard_normal(100), rng.standard_normal(100), np.zeros(5)]


def arm(rng: np.random.Generator, *, resolution: float = 1e-5, kind: float = 0.0) -> Arguments:
    """Two joints with friction that follow a reference in steps: they slide, stop and stick."""
    ticks, robot = 200, load("scara2")
    reference = np.zeros((ticks, 6))
    reference[:, :2] = np.repeat(rng.uniform(-0.1, 0.1, (2, 2)), ticks // 2, axis=0)
    reference[:20] = 0.0
    gains = np.zeros((2, 8))
    gains[:, :4] = [[800.0, 100.0, 5.0, 60.0], [25.0, 2.5, 0.5, 4.0]]
    gains[:, 4] = resolution
    gains[1, 5:] = 1e-5, 50.0, 0.3  # eccentricity of the encoder
    table = model(robot)
    joints = table.joints.copy()
    joints[:, [4, 9, 10, 20]] = 0.1  # Stribeck, load, drift and quadratic
    joints[:, [17, 18, 19]] = 500.0, 0.01, 20.0  # drives
    world = np.array([0.2, 0.0, 0.0, 0.2, 0.1, 0.0, 9.0])  # gravity, and vibration of the base
    plant = (table.body, table.motors, joints, COUPLING, world)
    return [
        reference,
        1e-6 * rng.standard_normal((ticks, 2)),
        np.empty((ticks, 18)),
        np.zeros((2, 2)),
        np.zeros(2),
        np.zeros((3, 2)),
        plant,
        (table.body, table.motors, table.joints, COUPLING, table.world),
        gains,
        np.array([0.001, 0.7, kind, 0.0, 3.0, 0.0]),
        2,
    ]


def chain(rng: np.random.Generator) -> Arguments:
    """Revolute and prismatic axes of any direction."""
    joints, samples = 4, 5
    axes = rng.standard_normal((joints, 16))
    axes[:, 15] = [0.0, 1.0, 0.0, 1.0]
    W = np.empty((samples * joints, 10 * joints))
    motion = rng.standard_normal((3, joints, samples))
    return [axes, rng.standard_normal(3), *motion, W, np.zeros((joints + 1, 21 + 6 * joints))]


def chain_torques(rng: np.random.Generator) -> Arguments:
    *motion, _W, links = chain(rng)
    return [*motion, rng.standard_normal((4, 10)), np.empty((4, 5)), links]


def chain_gradient(rng: np.random.Generator) -> Arguments:
    *motion, W, links = chain(rng)
    slopes = np.empty((3, 4, 5))
    return [*motion, rng.standard_normal(W.shape), *slopes, links, np.zeros_like(links)]


LINK = 26  # numbers of a link in the table `body` of an arm
COUPLING = np.array([[0.0, 1.0, 0.5, 1.0, 0.01, 0.05]])


def rigid(rng: np.random.Generator) -> Arguments:
    """A revolute and a prismatic axis in general position, and a joint that follows the first."""
    body = rng.standard_normal((3, 26))
    body[:, 12] = [0.0, 1.0, 0.0]
    body[:, 23] = [0.0, 1.0, 0.0]
    motion, pull = rng.standard_normal((2, 2)), rng.standard_normal(3)
    return [body, pull, motion, np.zeros(2), np.zeros((2, 2))]


def release(rng: np.random.Generator) -> Arguments:
    root = rng.standard_normal((4, 4))
    contact = np.zeros((9, 4))
    contact[1], contact[2:4], contact[5] = 2.0, 0.3, rng.standard_normal(4)
    return [root @ root.T + np.eye(4), contact]


CASES: dict[str, tuple[str, str, Callable[[np.random.Generator], Arguments]]] = {
    "p2smd": ("p2smd", "differentiate", p2smd),
    "p2smd, literal law": ("p2smd", "differentiate", p2smd_literal),
    "smd2": ("smd2", "differentiate", smd2),
    "astd": ("astd", "differentiate", astd),
    "p2smd, implicit": ("p2smd", "implicit", p2smd),
    "levant": ("levant", "differentiate", levant),
    "levant, Euler": ("levant", "differentiate", lambda rng: levant(rng, taylor=0)),
    "levant, filtering": ("levant", "differentiate", lambda rng: levant(rng, filters=2)),
    "implicit_levant": ("implicit_levant", "differentiate", implicit_levant),
    "implicit_levant, order 5": (
        "implicit_levant",
        "differentiate",
        lambda rng: implicit_levant(rng, 5),
    ),
    "tracking": ("tracking", "follow", tracking),
    "aise": ("aise", "differentiate", aise),
    "aise, order 1": ("aise", "differentiate", lambda rng: aise(rng, 1)),
    "kalman": ("kalman", "filtered", kalman),
    "kalman, records": ("kalman", "recorded", kalman_records),
    "kalman, lagged": ("kalman", "lagged", lagged),
    "kalman, smoothed": ("kalman", "smoothed", smoothed),
    "fir": ("fir", "filtered", fir),
    "sos": ("sos", "filtered", sos),
    "information": ("information", "update", information),
    "information, trace": ("information", "update", lambda rng: information(rng, trace=True)),
    "information, weights": (
        "information",
        "update",
        lambda rng: information(rng, 0.97, trace=True, weights=True),
    ),
    "information, forgetting": (
        "information",
        "update",
        lambda rng: information(rng, 0.97, trace=True),
    ),
    "information, several factors": (
        "information",
        "update",
        lambda rng: information(rng, (0.9, 1.0, 0.97, 0.99, 0.5), trace=True),
    ),
    "moments": ("moments", "accumulate", moments),
    "chain": ("chain", "regressor", chain),
    "chain, torques": ("chain", "torques", chain_torques),
    "chain, gradient": ("chain", "gradient", chain_gradient),
    "rigid": ("rigid", "dynamics", rigid),
    "friction, release": ("friction", "release", release),
    "friction, sign": ("friction", "sign", lambda rng: [rng.standard_normal()]),
    "control, encoder": ("control", "quantised", lambda rng: [rng.standard_normal(), 0.1]),
    "control, eccentric": ("control", "eccentric", lambda rng: list(rng.standard_normal(4))),
    "arm": ("arm", "run", arm),
    "arm, perfect encoder": ("arm", "run", lambda rng: arm(rng, resolution=0.0)),
    "arm, computed torque": ("arm", "run", lambda rng: arm(rng, kind=2.0)),
}


def leaves(arguments: Arguments) -> Arguments:
    """The arguments, with the members of those that are tuples."""
    return [x for group in arguments for x in (group if isinstance(group, tuple) else (group,))]
