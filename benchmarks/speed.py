"""Time per sample of the kernels, the differentiators and recursive least squares."""

from __future__ import annotations

import importlib.util
import re
import sys
import time
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any
from unittest.mock import patch

import numpy as np

import scarid_cli.kernels
from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS, ESTIMATORS
from scarid_cli.algorithms.plants.controllers import law
from scarid_cli.algorithms.plants.model import model
from scarid_cli.algorithms.regression.rows import plain
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.arrays import Array
from scarid_cli.kernels import arm, chain, fir, information, moments, p2smd, sos

FOLDER = Path(scarid_cli.kernels.__file__).parent

SAMPLES, INTERPRETED_SAMPLES = 200_000, 2000
KernelRun = Callable[[ModuleType, int], object]


def best(run: Callable[[], object], count: int) -> float:
    """Nanoseconds per item, the best of five rounds."""
    times = []
    for _ in range(5):
        start = time.perf_counter()
        run()
        times.append(time.perf_counter() - start)
    return min(times) / count * 1e9


def encoded(samples: int) -> Array:
    """Positions [rad] at 200 Hz as an encoder reads them."""
    t = np.arange(samples) / 200
    positions: Array = np.round((np.sin(t) + 0.3 * np.sin(7 * t)) / 1e-4) * 1e-4
    return positions


def interpreted(stem: str) -> ModuleType:
    """The same kernel as plain Python, not compiled, and so the kernels that it uses."""
    source = FOLDER / f"{stem}.py"
    spec = importlib.util.spec_from_file_location(f"interpreted_{stem}", source)
    assert spec is not None
    assert spec.loader is not None
    loaded = importlib.util.module_from_spec(spec)
    used = re.findall(
        r"^from (scarid_cli\.kernels\.(\w+)) import", source.read_text(), re.MULTILINE
    )
    with patch.dict(sys.modules, {name: interpreted(own) for name, own in used}):
        spec.loader.exec_module(loaded)
    return loaded


def kernels() -> None:
    """Each kernel compiled and interpreted."""
    print("\nKernels, ns per sample and joint (or per row of a regressor, or per control period)")
    print(f"  {'':30} {'compiled':>9} {'interpreted':>12}")
    for name, (module, run) in {**signals(), **regressions(), **chains(), **simulation()}.items():
        there = not str(module.__file__).endswith(".py")
        fast = f"{timed(run, module, SAMPLES):.1f}" if there else "none"
        stem = module.__name__.rpartition(".")[2]
        slow = timed(run, interpreted(stem) if there else module, INTERPRETED_SAMPLES)
        print(f"  {name:30} {fast:>9} {slow:12.0f}")


def timed(run: KernelRun, module: ModuleType, samples: int) -> float:
    return best(lambda: run(module, samples), samples)


def signals() -> dict[str, tuple[ModuleType, KernelRun]]:
    """Kernels that take the samples of one joint."""
    q, v, a = encoded(SAMPLES), np.zeros(SAMPLES), np.empty(SAMPLES)
    settings = np.array([25, 20, 0.1, 0, 2, 1.0])
    taps, sections = np.full(11, 1 / 11), np.full((2, 5), 0.1)
    return {
        "p2smd": (
            p2smd,
            lambda m, k: m.differentiate(q[:k], v[:k], a[:k], np.zeros(6), settings, 0.005),
        ),
        "fir of 11 taps": (fir, lambda m, k: m.filtered(q[:k], v[: k - 10], taps)),
        "filter, order 4": (
            sos,
            lambda m, k: m.filtered(q[:k], v[:k], np.zeros((2, 2)), sections),
        ),
        "validate": (moments, lambda m, k: m.accumulate(q[:k], v[:k], np.zeros(5))),
    }


def regressions() -> dict[str, tuple[ModuleType, KernelRun]]:
    """Least squares on rows of eight parameters, two rows per sample."""
    rng = np.random.default_rng(0)
    n = SAMPLES // 2
    W, y = rng.standard_normal((n, 2, 8)), rng.standard_normal((n, 2))

    def update(module: ModuleType, k: int, *, trace: bool) -> None:
        triangle = np.column_stack([0.1 * np.eye(8), np.zeros(8)])
        out = np.empty((k if trace else 0, 8))
        factors = np.full(8, 0.999 if trace else 1.0)
        work, sums, scales = np.empty(9), np.zeros(3), np.ones((k, 2))
        running = np.zeros((2 if trace else 0, 4))
        arrays = (W[:k], y[:k], scales, triangle, work, sums, out, factors)
        module.update(*arrays, 1e-12, running, 10.0)

    return {
        "ls, row of 8": (information, lambda m, k: update(m, k // 2, trace=False)),
        "rls, row of 8, with trace": (information, lambda m, k: update(m, k // 2, trace=True)),
    }


def chains() -> dict[str, tuple[ModuleType, KernelRun]]:
    """The regressor of six axes, 20 samples at a time, and its derivatives."""
    axes = np.random.default_rng(0).standard_normal((6, 16))
    axes[:, 15] = 0.0
    q = np.random.default_rng(1).standard_normal((6, 20))
    W, links, back = np.ones((120, 60)), np.empty((7, 57)), np.empty((7, 57))
    slopes = np.empty((3, 6, 20))
    arguments = (axes, np.ones(3), q, q, q, W)

    def gradient(module: ModuleType, k: int) -> None:
        for _ in range(k // 20):
            module.gradient(*arguments, *slopes, links, back)

    def regressor(module: ModuleType, k: int) -> None:
        for _ in range(k // 20):
            module.regressor(*arguments, links)

    return {
        "gradient of six axes, sample": (chain, gradient),
        "regressor of six axes, sample": (chain, regressor),
    }


def simulation() -> dict[str, tuple[ModuleType, KernelRun]]:
    """Simulated robots in their control loops."""
    return {
        f"simulate {name}, control period": (arm, period_of(name)) for name in ("emps", "scara2")
    }


def period_of(name: str) -> KernelRun:
    """Control periods of a robot at 1 kHz."""
    robot = load(name)
    n, tables = len(robot.joints), model(robot).tables
    q = np.tile(encoded(SAMPLES)[:, None], n)
    reference, noise = np.hstack([q, np.zeros((SAMPLES, 2 * n))]), np.zeros((SAMPLES, n))
    own = law(robot)
    gains = np.column_stack(
        (own.kp, own.kd, own.ki, np.full(n, 1e9), np.full(n, 1e-4), np.zeros((n, 3)))
    )
    setup = np.array([1e-3, 0.9, 0.0, 0.0, 0.0, 0.0])

    def run(module: ModuleType, k: int) -> None:
        state, lag, memory = np.zeros((2, n)), np.zeros(n), np.zeros((3, n))
        log = np.empty((k, 9 * n))
        module.run(
            reference[:k], noise[:k], log, state, lag, memory, tables, tables, gains, setup, 2
        )

    return run


def differentiators() -> None:
    """Every streaming method, in batches as a stage runs it."""
    q = encoded(100_000)

    def run(process: Any) -> None:
        state = process.init(q[0], 0.005)
        for start in range(0, len(q), 8192):
            state, _ = process.step(state, q[start : start + 8192])

    print("\nDifferentiators, ns per sample and joint at 200 Hz: unmatched, and matched")
    for name in DIFFERENTIATORS.names:
        method = DIFFERENTIATORS.load(name)()
        if method.lag(0.005) < np.inf:
            forms = (method, method.matched())
            unmatched, matched = (best(lambda form=form: run(form), len(q)) for form in forms)
            print(f"  {name:30} {unmatched:9.0f} {matched:12.0f}")
    implicit = DIFFERENTIATORS.load("p2smd")(implicit=1)
    print(f"  {'p2smd, implicit':30} {best(lambda: run(implicit), len(q)):9.0f}")


def estimators() -> None:
    """Recursive least squares of eight parameters beside that of padasip and of statsmodels."""
    rng = np.random.default_rng(0)
    rows, theta = 20_000, np.arange(1.0, 9.0)
    x = rng.standard_normal((rows, 8))
    y = x @ theta + 0.1 * rng.standard_normal(rows)
    print(f"\nRecursive least squares, ns per row of eight parameters, {rows} rows")
    # statsmodels has a diffuse initialisation, padasip starts from P0 = 100 I.
    for peer, p0, extra in ((padasip, 1e2, "compare"), (statsmodels, 1e9, "test")):
        if importlib.util.find_spec(peer.__name__):
            print(f"  {peer.__name__:14} {beside(peer, p0, x, y)}")
        else:
            print(f"  {peer.__name__:14} skipped: for it, pip install --editable '.[{extra}]'")


def beside(peer: Callable[[Array, Array], Any], p0: float, x: Array, y: Array) -> str:
    """Time and estimates of a peer beside ours."""
    difference = np.abs(np.asarray(peer(x, y)) / ours(x, y, p0, trace=False) - 1.0).max()
    theirs = best(lambda: peer(x, y), len(x))
    plainly, tracing = (
        best(lambda trace=trace: ours(x, y, p0, trace=trace), len(x)) for trace in (False, True)
    )
    return (
        f"{theirs:6.0f}; scarid {plainly:.0f}, {theirs / plainly:.0f} times as "
        f"fast; with the estimates after each row {tracing:.0f}, {theirs / tracing:.0f} times "
        f"as fast; the estimates differ by {difference:.1g} of themselves at most"
    )


def ours(x: Array, y: Array, p0: float, *, trace: bool) -> Array:
    rls = ESTIMATORS.load("rls")(p0=p0)
    regression = plain(x[:, None, :], y[:, None])
    state, _ = rls.step(rls.init(np.zeros(8)), regression, trace=trace)
    estimates: Array = rls.fit(state).fit.estimates
    return estimates


def padasip(x: Array, y: Array) -> Any:
    import padasip as peer

    filtering = peer.filters.FilterRLS(8, mu=1.0, eps=0.01, w=np.zeros(8))
    filtering.run(y, x)
    return filtering.w


def statsmodels(x: Array, y: Array) -> Any:
    import statsmodels.api as peer

    return peer.RecursiveLS(y, x).fit().params
