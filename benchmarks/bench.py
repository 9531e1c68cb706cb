"""Start-up, time per sample, and memory of the installed scarid, as one table of figures.

Every figure that depends on the machine's speed stands beside a baseline of the same run.
"""

from __future__ import annotations

import importlib.util
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS, ESTIMATORS
from scarid_cli.algorithms.regression.rows import plain
from scarid_cli.kernels import fir, information, moments, p2smd, plant, sos

SCARID = str(Path(sys.executable).parent / "scarid")
ROUNDS = 11
SHORT, LONG = 100_000, int(os.environ.get("ROWS", "10_000_000"))
# A child's peak begins at its parent's size, so the parent must be small.
LAUNCHER = """
import resource, subprocess, sys
subprocess.run(sys.argv[1:], stdout=subprocess.DEVNULL, check=True)
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss, file=sys.stderr)
"""
COLUMNS = ["t", "q1", "q2", "tau1", "tau2", "dq1", "dq2", "ddq1", "ddq2"]


def wall(command: list[str], source: Path | None = None) -> float:
    """Seconds of one run of a command."""
    with (source or Path(os.devnull)).open("rb") as stdin:
        start = time.perf_counter()
        subprocess.run(
            command, stdin=stdin, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        return time.perf_counter() - start


def startup(folder: Path) -> None:
    """The fixed cost of commands, against the imports they cannot do without, turn by turn."""
    log, motion, parameters = folder / "log.csv", folder / "motion.csv", folder / "parameters.csv"
    pipe = (
        f"{SCARID} trajgen -q --duration 2 | {SCARID} simulate -o {log} && "
        f"{SCARID} differentiate {log} -o {motion} && {SCARID} identify -q {motion} -o {parameters}"
    )
    subprocess.run(["bash", "-c", pipe], check=True)
    python = [sys.executable, "-c"]
    runs: dict[str, tuple[list[str], Path | None]] = {
        "import click": ([*python, "import click"], None),
        "scarid --help": ([SCARID, "--help"], None),
        "import click, numpy, pyarrow": ([*python, "import click, numpy, pyarrow"], None),
        "scarid filter": ([SCARID, "filter"], log),
        "scarid differentiate": ([SCARID, "differentiate"], log),
        "scarid identify": ([SCARID, "identify"], motion),
        "scarid validate": ([SCARID, "validate", "--parameters", str(parameters)], motion),
    }
    times: dict[str, list[float]] = {name: [] for name in runs}
    for _ in range(ROUNDS):
        for name, (command, source) in runs.items():
            times[name].append(wall(command, source))
    print(f"\nStart-up, median of {ROUNDS}, and ratio to the imports above it")
    base = 0.0
    for name, values in times.items():
        median = statistics.median(values)
        base = median if name.startswith("import") else base
        print(f"  {name:30} {1000 * median:7.0f} ms  {median / base:5.2f}")


def best(run: Callable[[], object], count: int) -> float:
    """Nanoseconds per item, the best of five rounds."""
    times = []
    for _ in range(5):
        start = time.perf_counter()
        run()
        times.append(time.perf_counter() - start)
    return min(times) / count * 1e9


def interpreted(module: ModuleType) -> ModuleType:
    """The same kernel, not compiled."""
    stem = module.__name__.rpartition(".")[2]
    source = Path(str(module.__file__)).parent / f"{stem}.py"
    spec = importlib.util.spec_from_file_location(f"interpreted_{stem}", source)
    assert spec is not None
    assert spec.loader is not None
    loaded = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(loaded)
    return loaded


def kernels() -> None:
    """Time per sample and joint, or per row of a regressor, compiled and interpreted."""
    n = 200_000
    rng = np.random.default_rng(0)
    t = np.arange(n) / 200
    q = np.round((np.sin(t) + 0.3 * np.sin(7 * t)) / 1e-4) * 1e-4
    v, a = np.empty(n), np.empty(n)
    W, y = rng.standard_normal((n // 2, 2, 8)), rng.standard_normal((n // 2, 2))
    noise, log = np.zeros((n, 2)), np.empty((n, 10))
    reference = np.column_stack([q, q, np.zeros(n), np.zeros(n)])
    model = np.array([3.42, 0.064, 0.131, 0.0, 0.07, 0.015, 0.58, 0.156, 0.0, 0.0])
    control = np.array([800, 25, 100, 2.5, 0, 0, 1e9, 1e9, 1e-4, 1e-4, 0.9])

    def update(module: ModuleType, k: int, *, trace: bool) -> None:
        triangle = np.column_stack([0.1 * np.eye(8), np.zeros(8)])
        out = np.empty((k if trace else 0, 8))
        factors = np.full(8, 0.999 if trace else 1.0)
        work, sums, scales = np.empty(9), np.zeros(3), np.ones((k, 2))
        module.update(W[:k], y[:k], scales, triangle, work, sums, out, factors, 1e-12)

    runs: dict[str, tuple[ModuleType, Callable[[ModuleType, int], object]]] = {
        "p2smd": (p2smd, lambda m, k: m.differentiate(
            q[:k], v[:k], a[:k], np.zeros(6), np.array([25, 20, 0.1, 0, 2, 1.0]), 0.005)),
        "fir of 11 taps": (fir, lambda m, k: m.filtered(q[:k], v[: k - 10], np.full(11, 1 / 11))),
        "filter, order 4": (sos, lambda m, k: m.filtered(
            q[:k], v[:k], np.zeros((2, 2)), np.full((2, 5), 0.1))),
        "ls, row of 8": (information, lambda m, k: update(m, k // 2, trace=False)),
        "rls, row of 8, with trace": (information, lambda m, k: update(m, k // 2, trace=True)),
        "validate": (moments, lambda m, k: m.accumulate(q[:k], v[:k], np.zeros(5))),
        "simulate, control tick": (plant, lambda m, k: m.run(
            reference[:k], noise[:k], log[:k], np.zeros(10), model, control, 1e-3, 4)),
    }  # fmt: skip
    v[:] = 0.0
    print("\nKernels, ns per sample and joint (or row, or tick)")
    print(f"  {'':30} {'compiled':>9} {'interpreted':>12}")
    for name, (module, run) in runs.items():
        if str(module.__file__).endswith(".py"):
            print(f"  {name:30} {'none':>9} {best(lambda: run(module, 2000), 2000):12.0f}")  # noqa: B023
            continue
        slow = interpreted(module)
        compiled = best(lambda: run(module, n), n)  # noqa: B023
        print(f"  {name:30} {compiled:9.1f} {best(lambda: run(slow, 2000), 2000):12.0f}")  # noqa: B023


def differentiators() -> None:
    """Time per sample and joint of every streaming method, in chunks as a stage runs it."""
    t = np.arange(100_000) / 200
    q = np.round((np.sin(t) + 0.3 * np.sin(7 * t)) / 1e-4) * 1e-4

    def run(process: Any) -> None:
        state = process.init(q[0], 0.005)
        for start in range(0, len(q), 8192):
            state, _ = process.step(state, q[start : start + 8192])

    print("\nDifferentiators, ns per sample and joint at 200 Hz, and of their matched forms")
    for name in DIFFERENTIATORS.names:
        method = DIFFERENTIATORS.load(name)()
        if method.lag(0.005) < np.inf:
            forms = [
                best(lambda form=form: run(form), len(q)) for form in (method, method.matched())
            ]
            print(f"  {name:30} {forms[0]:9.0f} {forms[1]:12.0f}")
    implicit = DIFFERENTIATORS.load("p2smd")(implicit=1)
    print(f"  {'p2smd, implicit':30} {best(lambda: run(implicit), len(q)):9.0f}")


def estimators() -> None:
    """Recursive least squares of padasip and statsmodels, the same estimates, per row of eight."""
    import padasip
    import statsmodels.api as sm

    rng = np.random.default_rng(0)
    rows, theta = 20_000, np.arange(1.0, 9.0)
    x = rng.standard_normal((rows, 8))
    y = x @ theta + 0.1 * rng.standard_normal(rows)
    regression = plain(x[:, None, :], y[:, None])

    def ours(p0: float, *, trace: bool) -> Any:
        rls = ESTIMATORS.load("rls")(p0=p0)
        state, _ = rls.step(rls.init(np.zeros(8)), regression, trace=trace)
        return rls.fit(state).fit.estimates

    def padasip_s() -> Any:
        filtering = padasip.filters.FilterRLS(8, mu=1.0, eps=0.01, w=np.zeros(8))
        filtering.run(y, x)
        return filtering.w

    def statsmodels_s() -> Any:
        return sm.RecursiveLS(y, x).fit().params

    print(f"\nRecursive least squares, ns a row of eight parameters, {rows} rows")
    # statsmodels starts diffuse, padasip from P0 = 100 I.
    for name, peer, p0 in (("padasip", padasip_s, 1e2), ("statsmodels", statsmodels_s, 1e9)):
        apart = np.abs(np.asarray(peer()) / ours(p0, trace=False) - 1.0).max()
        theirs = best(peer, rows)
        own = [best(lambda trace=t: ours(p0, trace=trace), rows) for t in (False, True)]  # noqa: B023
        print(
            f"  {name:14} {theirs:6.0f}; scarid {own[0]:.0f}, {theirs / own[0]:.0f} times as fast;"
            f" with estimates after each row {own[1]:.0f}, {theirs / own[1]:.0f} times;"
            f" estimates within {apart:.1g}"
        )


def stream(rows: int) -> None:
    """Write a motion of so many rows to standard output, as an Arrow stream."""
    schema = pa.schema([(name, pa.float64()) for name in COLUMNS])
    with pa.ipc.new_stream(sys.stdout.buffer, schema) as writer:
        for start in range(0, rows, 8192):
            t = np.arange(start, min(start + 8192, rows)) / 200
            q, dq = [np.sin(t), np.sin(1.3 * t)], [np.cos(t), 1.3 * np.cos(1.3 * t)]
            ddq = [-np.sin(t) - 0.5 * np.sin(3 * t), -1.69 * np.sin(1.3 * t)]
            columns = [t, *q, 3.0 * q[0], q[1], *dq, *ddq]
            writer.write_batch(
                pa.RecordBatch.from_arrays([pa.array(c) for c in columns], schema=schema)
            )


AXES = 6
AXIS_ROWS = 1_000_000


def stream_six(rows: int) -> None:
    """The same of a log of six axes."""
    names = [f"{signal}{i}" for signal in ("q", "tau") for i in range(1, AXES + 1)]
    schema = pa.schema([(name, pa.float64()) for name in ["t", *names]])
    with pa.ipc.new_stream(sys.stdout.buffer, schema) as writer:
        for start in range(0, rows, 8192):
            t = np.arange(start, min(start + 8192, rows)) / 1000
            q = [np.sin((1.0 + 0.17 * i) * t) + 0.3 * np.cos(0.41 * i * t) for i in range(AXES)]
            columns = [t, *q, *(np.cos(x) + x for x in q)]
            arrays = [pa.array(column) for column in columns]
            writer.write_batch(pa.RecordBatch.from_arrays(arrays, schema=schema))


def six_axes(folder: Path) -> None:
    """A log of six axes through filter, differentiate and identify, by a URDF."""
    axes = ("0 0 1", "0 1 0", "0 1 0", "1 0 0", "0 1 0", "1 0 0")
    parts = ['<robot name="arm"><link name="link0"/>']
    for i, axis in enumerate(axes, start=1):
        parts.append(
            f'<joint name="j{i}" type="revolute"><parent link="link{i - 1}"/>'
            f'<child link="link{i}"/><origin xyz="0.2 0 0.1"/><axis xyz="{axis}"/>'
            '<limit lower="-3" upper="3" effort="9" velocity="9"/></joint>'
            f'<link name="link{i}"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0"'
            ' iyy="1" iyz="0" izz="1"/></inertial></link>'
        )
    (folder / "arm.urdf").write_text("".join(parts) + "</robot>")
    robot = str(folder / "arm.urdf")
    made = f"{sys.executable} {__file__} six"
    pipe = (
        f"{made} {{rows}} | {SCARID} filter --format arrow | {SCARID} differentiate --format arrow"
    )
    print(f"\nSix axes, peak memory of the last stage on 50,000 and {AXIS_ROWS:,} rows")
    for name, last in (
        ("filter | differentiate", ""),
        ("... | identify, 61 parameters", f"{SCARID} identify -q --robot {robot}"),
    ):
        peaks, seconds = [], 0.0
        for rows in (50_000, AXIS_ROWS):
            *before, end = pipe.format(rows=rows).split(" | ")
            stages = " | ".join([*before, end]) if last else " | ".join(before)
            with subprocess.Popen(["bash", "-c", stages], stdout=subprocess.PIPE) as source:
                start = time.perf_counter()
                done = subprocess.run(
                    [sys.executable, "-c", LAUNCHER, *(last or end).split()],
                    stdin=source.stdout, capture_output=True, check=True,
                )  # fmt: skip
            seconds = time.perf_counter() - start
            peaks.append(int(done.stderr.split()[-1]) / 1024)
        print(
            f"  {name:30} {peaks[0]:6.1f} MB {peaks[1]:6.1f} MB  ratio {peaks[1] / peaks[0]:5.3f}"
            f"  {seconds / AXIS_ROWS * 1e6:6.2f} us a row"
        )


def peak(words: list[str], rows: int) -> tuple[float, float]:
    """Peak memory [MB] and time [s] of a stage that reads so many rows from a pipe."""
    with subprocess.Popen(
        [sys.executable, __file__, "stream", str(rows)], stdout=subprocess.PIPE
    ) as source:
        start = time.perf_counter()
        done = subprocess.run(
            [sys.executable, "-c", LAUNCHER, SCARID, *words],
            stdin=source.stdout,
            capture_output=True,
            check=True,
        )
    return int(done.stderr.split()[-1]) / 1024, time.perf_counter() - start


def stages(folder: Path) -> dict[str, list[str]]:
    """The streaming stages whose memory must not depend on the number of rows."""
    parameters = folder / "p.csv"
    with subprocess.Popen(
        [sys.executable, __file__, "stream", "2000"], stdout=subprocess.PIPE
    ) as source:
        identify = [SCARID, "identify", "-q", "-o", str(parameters)]
        subprocess.run(identify, stdin=source.stdout, check=True)
    return {
        "resample": ["resample", "-q", "--rate", "60", "--format", "arrow"],
        "filter": ["filter", "--format", "arrow"],
        "differentiate": ["differentiate", "--format", "arrow"],
        "identify": ["identify", "-q"],
        "validate": ["validate", "--parameters", str(parameters)],
    }


def memory(folder: Path) -> None:
    """Peak memory on a short and a long stream."""
    print(f"\nPeak memory, Arrow stream of {SHORT:,} and {LONG:,} rows")
    for name, words in stages(folder).items():
        (short, _), (long, seconds) = peak(words, SHORT), peak(words, LONG)
        print(
            f"  {name:30} {short:6.1f} MB {long:6.1f} MB  ratio {long / short:5.3f}"
            f"  {seconds / LONG * 1e6:6.2f} us a row"
        )


def main() -> None:
    if sys.argv[1:2] == ["stream"]:
        stream(int(sys.argv[2]))
        return
    if sys.argv[1:2] == ["six"]:
        stream_six(int(sys.argv[2]))
        return
    subprocess.run([SCARID, "--version"], check=True)
    with tempfile.TemporaryDirectory() as folder:
        startup(Path(folder))
        kernels()
        differentiators()
        estimators()
        memory(Path(folder))
        six_axes(Path(folder))


if __name__ == "__main__":
    main()
