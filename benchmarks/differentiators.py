"""Every differentiator and its peers on known signals: `make bench-differentiators`.

Everything is tuned blind: by `scarid tune` on the noisy record itself, peers by their own tuner.
The column `of truth` is the error over that of settings chosen by the truth. NRMSE is the
root-mean-square error over the deviation of the true signal; score is 100 times the geometric mean
over six motions of the root of both. Delay: of the acceleration, of the least squared error.
Settling: until velocity errors stay under a tenth of the deviation, started in full motion.
Glitch: largest change of the acceleration that one sample of 0.1 rad makes. Vibration: NRMSE of
the acceleration with 10 mrad at 70 Hz. Rest: root-mean-square acceleration in ten seconds of
standstill.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache, partial
from math import inf, nan
from pathlib import Path
from typing import Any

import numpy as np
import peers
from signals import INNER, H, Run, errors, glitched, runs, seen, shaken

from scarid_cli.algorithms.choices.ranges import Range
from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.algorithms.processes.delays import lateness
from scarid_cli.algorithms.processes.matching import over
from scarid_cli.algorithms.tuning import judges, search
from scarid_cli.arrays import Array

CLASSES = ("causal", "fixed lag", "whole record")
BITS = (13, 16)
CHUNK = 8192


@dataclass
class Row:
    """What was measured of a method at one resolution, motion by motion."""

    name: str
    kind: str
    bits: int
    ours: bool
    seeds: list[int] = field(default_factory=list)
    v: list[float] = field(default_factory=list)
    a: list[float] = field(default_factory=list)
    informed: list[float] = field(default_factory=list)
    delay: list[float] = field(default_factory=list)
    settling: list[float] = field(default_factory=list)
    glitch: list[float] = field(default_factory=list)
    vibration: list[float] = field(default_factory=list)
    rest: list[float] = field(default_factory=list)
    cost: float = nan

    @property
    def score(self) -> float:
        return 100.0 * geometric(np.sqrt(np.multiply(self.v, self.a)))

    @property
    def of_truth(self) -> float:
        return self.score / (100.0 * geometric(self.informed)) if self.informed else nan


def geometric(values: Any) -> float:
    return float(np.exp(np.mean(np.log(values))))


def blind(name: str, q: Array) -> Any:
    """The method as `scarid tune` sets it."""
    method = DIFFERENTIATORS.load(name)()
    if method.TUNES_ITSELF:
        return method.fitted(q, H)
    if method.HAS_LIKELIHOOD:
        return judges.fit(method, q, H)
    judge = judges.distance_to_smoother(q, H)
    return min(search.search(method, method.TUNED, judge, H, 0), key=lambda t: t.loss).method


def derivatives(method: Any, q: Array) -> tuple[Array, ...]:
    return over(method, q, H)


def informed(method: Any, q: Array, run: Run) -> float:
    """The error with the settings that the truth would choose, from the blind ones on."""
    ranges = method.TUNED or ({"intensity": Range(1e-3, 1e8)} if method.HAS_LIKELIHOOD else {})

    def judge(tried: Any) -> float:
        with np.errstate(all="ignore"):
            v, a = errors(*over(tried, q, H), run)
        return float(np.sqrt(v * a))

    return min(trial.loss for trial in search.search(method, ranges, judge, H, 0))


def kind_of(method: Any) -> str:
    lag = method.lag(H)
    return CLASSES[0] if lag == 0 else CLASSES[2] if lag == inf else CLASSES[1]


def measure(row: Row, sensor: Callable[[Array], Any], run: Run, bits: int, seed: int) -> None:
    """The errors on one motion."""
    start = time.perf_counter()
    v, a = sensor(seen(run.q, bits, seed))
    row.cost = (time.perf_counter() - start) / len(run.q) * 1e9
    errors_v, errors_a = errors(v, a, run)
    row.seeds.append(seed)
    row.v.append(errors_v)
    row.a.append(errors_a)
    row.delay.append(1e3 * lateness(a[INNER], run.a[INNER], H))


def disturb(row: Row, sensor: Callable[[Array], Any], run: Run, bits: int, seed: int) -> None:
    """A start in motion, a glitch, a vibration and a standstill."""
    q = seen(run.q, bits, seed)
    v, a = sensor(q)
    middle = int(np.argmax(np.abs(run.v)))
    start = min(middle, len(q) - 800)
    begun, _ = sensor(q[start : start + 800])
    off = np.abs(begun - run.v[start : start + 800]) > 0.1 * np.std(run.v)
    row.settling.append(1e3 * H * (int(np.flatnonzero(off)[-1]) + 1 if off.any() else 0))
    _, wrong = sensor(glitched(q, 2000))
    row.glitch.append(float(np.abs(wrong - a)[INNER].max()))
    _, trembling = sensor(seen(shaken(run.q), bits, seed))
    row.vibration.append(errors(v, trembling, run)[1])
    if seed == 0:
        rest = seen(np.concatenate((run.q[:2000], np.full(10_000, run.q[2000]))), bits, seed)
        row.rest.append(float(np.sqrt(np.mean(sensor(rest)[1][-2200:-200] ** 2))))


def cost(process: Any, q: Array) -> float:
    """Nanoseconds per sample, in chunks as a stage runs it."""
    long = np.tile(q, 10)
    best = inf
    for _ in range(3):
        start = time.perf_counter()
        state = process.init(long[0], H)
        for at in range(0, len(long), CHUNK):
            state, _ = process.step(state, long[at : at + CHUNK])
        process.finish(state)
        best = min(best, time.perf_counter() - start)
    return best / len(long) * 1e9


def ours(motions: list[Run], bits: int) -> list[Row]:
    rows = []
    for name in DIFFERENTIATORS.names:
        row = Row(name, kind_of(DIFFERENTIATORS.load(name)()), bits, ours=True)
        for seed, run in enumerate(motions):
            q = seen(run.q, bits, seed)
            method = blind(name, q)
            sensor = partial(derivatives, method)
            measure(row, sensor, run, bits, seed)
            disturb(row, sensor, run, bits, seed)
            row.informed.append(informed(method, q, run))
        row.cost = cost(method, q)
        rows.append(row)
        print(f"  {bits} bit  {name:18} {row.score:7.2f}", flush=True)
    return rows


Maker = Callable[[int], list[peers.Sensor]]


def makers(seen_by: list[Array]) -> list[tuple[str, str, Maker]]:
    """Name, class and tuning of each peer; from the positions of a motion, by its number.

    Each PyNumDiff method is set by its `optimize` on the first motion of each kind.
    """
    found = peers.present()
    made: list[tuple[str, str, Maker]] = []
    if found["AlgDiff"]:
        made.append(("AlgDiff", CLASSES[0], lambda k: [peers.tuned_algdiff(seen_by[k])]))
        made.append(("AlgDiff, shifted", CLASSES[1], lambda k: [_shifted(seen_by[k])]))
    if found["derivative"]:
        for name, (kind, settings) in peers.DERIVATIVE.items():
            sensor = peers.derivative(kind, settings)
            made.append((name, CLASSES[2], lambda _, sensor=sensor: [sensor]))
    if found["pynumdiff"]:

        @cache
        def optimised(name: str, kind: int) -> list[peers.Sensor]:
            return list(peers.pynumdiff(name, seen_by[2 * kind]))

        made += [
            (f"pynumdiff {name}", CLASSES[2], lambda k, name=name: optimised(name, k // 2))
            for name in peers.SPACES
        ]
    return made


def _shifted(q: Array) -> peers.Sensor:
    return peers.shifted(peers.tuned_algdiff(q), q)


def others(motions: list[Run], bits: int) -> list[Row]:
    """The peers."""
    rows = []
    for name, kind, make in makers([seen(run.q, bits, k) for k, run in enumerate(motions)]):
        try:
            candidates = tried(name, kind, make, motions, bits)
        except Exception as error:  # a peer that fails is told, and the run goes on
            print(f"  {name}: {type(error).__name__}: {error}"[:100])
            continue
        rows.append(min(candidates, key=lambda row: geometric(row.a)))
        print(f"  {bits} bit  {name:22} {rows[-1].score:7.2f}", flush=True)
    return rows


def tried(name: str, kind: str, make: Maker, motions: list[Run], bits: int) -> list[Row]:
    """One row for each way to run a peer."""
    rows: list[Row] = []
    step = 2 if name.split()[-1] in peers.SLOW else 1  # one motion of each kind
    for seed, run in list(enumerate(motions))[::step]:
        sensors = make(seed)
        rows = rows or [Row(name, kind, bits, ours=False) for _ in sensors]
        for row, sensor in zip(rows, sensors, strict=True):
            measure(row, sensor, run, bits, seed)
            if kind != CLASSES[2]:  # those of the whole record take minutes for a minute
                disturb(row, sensor, run, bits, seed)
    return rows


def cell(values: list[float], digits: int) -> str:
    return f"{np.median(values):.{digits}f}" if values else "-"


def table(rows: list[Row], kind: str, bits: int) -> None:
    chosen = sorted((r for r in rows if (r.kind, r.bits) == (kind, bits)), key=lambda r: r.score)
    print(f"\n{kind}, {bits} bit")
    print(f"  {'':24}{'score':>7}{'NRMSE v':>9}{'NRMSE a':>9}{'of truth':>9}{'delay':>8}"
          f"{'settling':>9}{'glitch':>8}{'vibration':>10}{'rest':>8}{'cost':>9}")  # fmt: skip
    print(f"  {'':50}{'ms':>16}{'ms':>9}{'rad/s2':>8}{'NRMSE a':>10}{'rad/s2':>8}{'ns':>9}")
    for r in chosen:
        truth = f"{r.of_truth:9.2f}" if r.informed else f"{'-':>9}"
        print(f"  {r.name:24}{r.score:7.2f}{geometric(r.v):9.4f}{geometric(r.a):9.4f}{truth}"
              f"{cell(r.delay, 1):>8}{cell(r.settling, 0):>9}{cell(r.glitch, 2):>8}"
              f"{cell(r.vibration, 2):>10}{cell(r.rest, 3):>8}{r.cost:9.0f}")  # fmt: skip


def before(row: Row, other: Row) -> bool:
    """In velocity and in acceleration, over the motions of both."""
    return all(
        geometric([getattr(row, signal)[seed] for seed in other.seeds])
        < geometric(getattr(other, signal))
        for signal in ("v", "a")
    )


def claims(rows: list[Row]) -> None:
    """What the tables say, computed."""
    print("\nClaims")
    for kind in CLASSES:
        for bits in BITS:
            here = [r for r in rows if (r.kind, r.bits) == (kind, bits)]
            mine, theirs = [r for r in here if r.ours], [r for r in here if not r.ours]
            best = min(mine, key=lambda r: r.score)
            beaten = all(before(best, r) for r in theirs)
            print(f"  {kind}, {bits} bit: {best.name} is before every peer in velocity and in "
                  f"acceleration: {beaten if theirs else 'no peer'}")  # fmt: skip
    for bits in BITS:
        for name in ("kalman", "rts"):
            row = next(r for r in rows if (r.name, r.bits) == (name, bits))
            print(f"  {name}, {bits} bit, over settings chosen by the truth: {row.of_truth:.2f}")
        mine = next(r for r in rows if (r.name, r.bits) == ("rts", bits))
        for name in peers.ITERATIVE:
            for row in rows:
                if (row.name, row.bits) == (f"pynumdiff {name}", bits):
                    faster = row.cost / mine.cost
                    print(f"  rts, {bits} bit, over pynumdiff {name}: {faster:.0f} times as fast, "
                          f"score {mine.score:.2f} against {row.score:.2f}")  # fmt: skip


def draw(rows: list[Row], folder: Path) -> None:
    """Velocity and acceleration errors per class, both resolutions."""
    from matplotlib.figure import Figure

    folder.mkdir(parents=True, exist_ok=True)
    for kind in CLASSES:
        here = [r for r in rows if r.kind == kind]
        scores = {r.name: r.score for r in here if r.bits == BITS[0]}
        names = sorted(scores, key=lambda name: scores[name])
        figure = Figure(figsize=(7.0, 1.2 + 0.24 * len(names)), layout="constrained")
        panels = figure.subplots(1, 2, sharey=True)
        for axes, signal in zip(panels, ("v", "a"), strict=True):
            for bits, colour in zip(BITS, ("#d55e00", "#0072b2"), strict=True):
                for r in here:
                    if r.bits == bits and r.name in names:
                        axes.plot(geometric(getattr(r, signal)), names.index(r.name), color=colour,
                                  marker="o" if r.ours else "x", linestyle="none")  # fmt: skip
            axes.set_xscale("log")
            axes.grid(color="#e4e4e4")
            axes.set_xlabel(f"NRMSE of the {'velocity' if signal == 'v' else 'acceleration'}")
        panels[0].set_yticks(range(len(names)), names)
        panels[0].invert_yaxis()
        figure.suptitle(f"{kind}: 13 bit (orange), 16 bit (blue); x: peers", fontsize=9)
        figure.savefig(folder / f"{kind.replace(' ', '-')}.svg")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--no-peers", action="store_true")
    parser.add_argument("--output", type=Path, default=Path("build/differentiators"))
    options = parser.parse_args()
    missing = [name for name, there in peers.present().items() if not there]
    if missing:
        print(f"Not installed, left out: {', '.join(missing)}")
    motions, rows = runs(), []
    for bits in BITS:
        rows += ours(motions, bits)
        rows += [] if options.no_peers else others(motions, bits)
    for kind in CLASSES:
        for bits in BITS:
            table(rows, kind, bits)
    claims(rows)
    draw(rows, options.output)
    print(f"\nFigures: {options.output}")


if __name__ == "__main__":
    main()
