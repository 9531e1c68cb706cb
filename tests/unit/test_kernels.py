"""Every kernel runs compiled, and gives the bits of its interpreted source."""

from __future__ import annotations

import importlib
import itertools
import re
from collections.abc import Callable, Iterator
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from speed import FOLDER, interpreted

from scarid_cli.algorithms.differentiators.kalman import Differentiator as Kalman
from scarid_cli.algorithms.filters.butterworth import Butterworth
from scarid_cli.algorithms.filters.kalman import Records
from scarid_cli.algorithms.plants.model import model
from scarid_cli.algorithms.robots.reading import load

NAMES = sorted(path.stem for path in FOLDER.glob("*.pxd"))

Arguments = list[Any]


def compiled(name: str) -> ModuleType:
    return importlib.import_module(f"scarid_cli.kernels.{name}")


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
    joints[:, [4, 9, 10]] = 0.1  # Stribeck, load and drift
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


def chain_gradient(rng: np.random.Generator) -> Arguments:
    *motion, W, links = chain(rng)
    slopes = np.empty((3, 4, 5))
    return [*motion, rng.standard_normal(W.shape), *slopes, links, np.zeros_like(links)]


COUPLING = np.array([[0.0, 1.0, 0.5, 1.0, 0.01, 0.05]])


def rigid(rng: np.random.Generator) -> Arguments:
    """A revolute and a prismatic axis in general position."""
    body = rng.standard_normal((2, 23))
    body[:, 12] = [0.0, 1.0]
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


@pytest.mark.parametrize("name", NAMES)
def test_kernel_is_compiled(name: str) -> None:
    file = compiled(name).__file__ or ""
    assert file.endswith(".so"), (
        f"kernel {name} runs interpreted, from {file}: python setup.py build_ext --inplace"
    )


def test_every_public_function_is_compared_with_its_source() -> None:
    sources = {path.stem for path in FOLDER.glob("*.py")} - {"__init__"}
    assert sources == set(NAMES), "a kernel without its .pxd is not compiled"
    public = {
        (name, function)
        for name in NAMES
        for function in re.findall(r"^cpdef .*?(\w+)\(", (FOLDER / f"{name}.pxd").read_text(), re.M)
    }
    assert {(kernel, function) for kernel, function, _ in CASES.values()} == public


def bits(x: Any) -> np.ndarray:
    """The bits, which distinguish -0 from 0."""
    return np.asarray(x, dtype=np.float64).view(np.int64)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("case", CASES)
def test_compiled_and_interpreted_bits_are_equal(case: str, seed: int) -> None:
    kernel, function, arguments = CASES[case]
    ours, theirs = (arguments(np.random.default_rng(seed)) for _ in range(2))
    fast = getattr(compiled(kernel), function)(*ours)
    slow = getattr(interpreted(kernel), function)(*theirs)
    assert fast == slow
    for mine, other in zip(leaves(ours), leaves(theirs), strict=True):
        np.testing.assert_array_equal(bits(mine), bits(other))


def leaves(arguments: Arguments) -> Arguments:
    """The arguments, with the members of those that are tuples."""
    return [x for group in arguments for x in (group if isinstance(group, tuple) else (group,))]


@pytest.mark.parametrize("case", ["arm", "arm, perfect encoder"])
def test_arm_case_does_slide_and_stick(case: str) -> None:
    """Else the comparison of bits above would leave out half of the kernel."""
    arguments = CASES[case][2](np.random.default_rng(0))
    assert compiled("arm").run(*arguments) == len(arguments[0])
    still = arguments[2][:, 6:8] == 0.0
    assert still.any(axis=0).all()
    assert not still.all(axis=0).any()


def wrong_lengths() -> Iterator[Any]:
    """Each array of each kernel, along each of its axes, one too short or too long."""
    variants = {"levant, Euler", "kalman, lagged"}  # whose records and outputs may differ in length
    one = {(kernel, function): case for case, (kernel, function, _) in CASES.items()}
    for case in sorted(set(one.values()) - variants):
        for index, argument in enumerate(leaves(CASES[case][2](np.random.default_rng(0)))):
            for axis in range(np.ndim(argument)):
                if argument is COUPLING and axis == 0:
                    continue  # an arm may have any number of them
                for change in (-1, 1):
                    label = f"{case} argument {index} axis {axis} {change:+d}"
                    yield pytest.param(case, index, axis, change, id=label)


def resized(array: np.ndarray, axis: int, change: int) -> np.ndarray:
    """Zeros of the array's shape but for one axis, within a larger piece of memory.

    A kernel that misses the wrong length reads and writes beyond it, but harms nothing.
    """
    shape = list(array.shape)
    shape[axis] += change
    memory = np.zeros(2 * array.size + 64)
    return memory[: int(np.prod(shape))].reshape(shape)


def replaced(arguments: Arguments, index: int, change: Callable[[Any], Any]) -> Arguments:
    """The arguments with one of their leaves changed."""
    numbers = itertools.count()

    def one(x: Any) -> Any:
        return change(x) if next(numbers) == index else x

    return [
        tuple(map(one, group)) if isinstance(group, tuple) else one(group) for group in arguments
    ]


@pytest.mark.parametrize("load_kernel", [compiled, interpreted])
@pytest.mark.parametrize(("case", "index", "axis", "change"), list(wrong_lengths()))
def test_wrong_length_is_refused(
    case: str, index: int, axis: int, change: int, load_kernel: Callable[[str], ModuleType]
) -> None:
    kernel, function, make = CASES[case]
    arguments = replaced(
        make(np.random.default_rng(0)), index, lambda array: resized(array, axis, change)
    )
    with pytest.raises(ValueError, match=r"lengths|numbers|sizes"):
        getattr(load_kernel(kernel), function)(*arguments)
