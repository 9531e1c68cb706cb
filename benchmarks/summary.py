"""What the benchmark of the differentiators shows: tables, claims computed from them, figures."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import peers
from scores import CLASSES, Score, geometric

BITS = (13, 16)
COLOURS = {13: "#d55e00", 16: "#0072b2"}


def tables(scores: Sequence[Score]) -> None:
    """A table for each class and resolution, the best method first."""
    for kind in CLASSES:
        for bits in BITS:
            if found := of(scores, kind, bits):
                table(found, f"{kind}, {bits} bit")


def of(scores: Sequence[Score], kind: str, bits: int) -> list[Score]:
    """Those of one class at one resolution."""
    return [s for s in scores if (s.kind, s.bits) == (kind, bits)]


def table(scores: Sequence[Score], title: str) -> None:
    print(f"\n{title}")
    print(f"  {'':24}{'score':>7}{'NRMSE v':>9}{'NRMSE a':>9}{'of truth':>9}{'delay':>8}"
          f"{'settling':>9}{'glitch':>8}{'vibration':>10}{'rest':>8}{'cost':>9}")  # fmt: skip
    print(f"  {'':50}{'ms':>16}{'ms':>9}{'rad/s2':>8}{'NRMSE a':>10}{'rad/s2':>8}{'ns':>9}")
    for s in sorted(scores, key=lambda s: s.total):
        truth = f"{s.of_truth:9.2f}" if s.informed else f"{'-':>9}"
        print(f"  {s.name:24}{s.total:7.2f}{geometric(s.v):9.4f}{geometric(s.a):9.4f}{truth}"
              f"{cell(s.delay, 1):>8}{cell(s.settling, 0):>9}{cell(s.glitch, 2):>8}"
              f"{cell(s.vibration, 2):>10}{cell(s.rest, 3):>8}{s.cost:9.0f}")  # fmt: skip


def cell(values: list[float], digits: int) -> str:
    """The median of the motions."""
    return f"{np.median(values):.{digits}f}" if values else "-"


def claims(scores: Sequence[Score]) -> None:
    """What can be claimed from the tables, computed."""
    print("\nClaims")
    for kind in CLASSES:
        for bits in BITS:
            best_of_class(of(scores, kind, bits), f"{kind}, {bits} bit")
    for bits in BITS:
        here = {s.name: s for s in scores if s.bits == bits}
        for name in ("kalman", "rts"):
            ratio = f"{here[name].of_truth:.2f} times that with settings chosen by the truth"
            print(f"  {name}, {bits} bit: the error is {ratio}")
        for name in peers.ITERATIVE:
            if peer := here.get(f"pynumdiff {name}"):
                faster = peer.cost / here["rts"].cost
                print(f"  rts, {bits} bit: {faster:.0f} times as fast as pynumdiff {name}, "
                      f"score {here['rts'].total:.2f} against {peer.total:.2f}")  # fmt: skip


def best_of_class(scores: Sequence[Score], title: str) -> None:
    """Whether the best method here has smaller errors than every peer."""
    best = min((s for s in scores if s.ours), key=lambda s: s.total)
    rivals = [s for s in scores if not s.ours]
    beaten = all(better(best, s) for s in rivals)
    answer = ("yes" if beaten else "no") if rivals else "there is no peer"
    print(
        f"  {title}: is {best.name} better than every peer in velocity and acceleration? {answer}"
    )


def better(score: Score, other: Score) -> bool:
    """In velocity and in acceleration, over the motions that both have."""
    return all(
        geometric([getattr(score, signal)[seed] for seed in other.seeds])
        < geometric(getattr(other, signal))
        for signal in ("v", "a")
    )


def draw(scores: Sequence[Score], folder: Path) -> None:
    """A figure for each class: errors of velocity and acceleration at both resolutions."""
    folder.mkdir(parents=True, exist_ok=True)
    for kind in CLASSES:
        chosen = [s for s in scores if s.kind == kind]
        totals = {s.name: s.total for s in chosen if s.bits == BITS[0]}
        names = sorted(totals, key=lambda name: totals[name])
        figure = drawn([s for s in chosen if s.name in totals], names)
        figure.suptitle(f"{kind}: 13 bit (orange), 16 bit (blue); crosses are peers", fontsize=9)
        figure.savefig(folder / f"{kind.replace(' ', '-')}.svg")


def drawn(scores: Sequence[Score], names: list[str]) -> Any:
    """Two panels, a line for each method."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 1.2 + 0.24 * len(names)), layout="constrained")
    panels = figure.subplots(1, 2, sharey=True)
    for axes, signal in zip(panels, ("v", "a"), strict=True):
        for s in scores:
            axes.plot(geometric(getattr(s, signal)), names.index(s.name), color=COLOURS[s.bits],
                      marker="o" if s.ours else "x", linestyle="none")  # fmt: skip
        axes.set_xscale("log")
        axes.grid(color="#e4e4e4")
        axes.set_xlabel(f"NRMSE of the {'velocity' if signal == 'v' else 'acceleration'}")
    panels[0].set_yticks(range(len(names)), names)
    panels[0].invert_yaxis()
    return figure
