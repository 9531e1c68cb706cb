"""Every differentiator and its peers on known motions: `make bench-differentiators`.

All methods are tuned without the truth: ours by `scarid tune` on the noisy positions themselves,
peers by their own tuner. The columns of the tables:

score      100 times the geometric mean, over six motions, of the root of NRMSE v times NRMSE a
NRMSE      root-mean-square error over the standard deviation of the true velocity or acceleration
of truth   error over that with settings chosen by the truth
delay      time by which the estimated acceleration is shifted for the least squared error
settling   time until the error of the velocity stays below a tenth of its standard deviation,
           started in full motion
glitch     largest change of the acceleration that a single sample 0.1 rad off causes
vibration  NRMSE of the acceleration with an added vibration of 10 mrad at 70 Hz
rest       root-mean-square acceleration in ten seconds of standstill
cost       time per sample
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np
import peers
import summary
from scores import CLASSES, Score, class_of, cost, geometric
from signals import H, TrueMotion, errors, motions, seen

from scarid_cli.algorithms.choices.ranges import Range
from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.algorithms.filters.likelihood import best_model
from scarid_cli.algorithms.processes.matching import over
from scarid_cli.algorithms.tuning import judges, search
from scarid_cli.arrays import Array


def blind(name: str, q: Array) -> Any:
    """The method with the settings that `scarid tune` chooses from these positions."""
    method = DIFFERENTIATORS.load(name)()
    if method.TUNES_ITSELF:
        return method.fitted(q, H)
    if method.HAS_LIKELIHOOD:
        return best_model(method, q, H)
    judge = judges.distance_to_smoother(q, H)
    return min(search.search(method, method.TUNED, judge, H, 0), key=lambda t: t.loss).method


def derivatives(method: Any, q: Array) -> tuple[Array, ...]:
    return over(method, q, H)


def informed(method: Any, q: Array, motion: TrueMotion) -> float:
    """The error with the settings that the truth would choose, searched from the blind ones."""
    ranges = method.TUNED or ({"intensity": Range(1e-3, 1e8)} if method.HAS_LIKELIHOOD else {})

    def judge(tried: Any) -> float:
        with np.errstate(all="ignore"):
            v, a = errors(*over(tried, q, H), motion)
        return float(np.sqrt(v * a))

    return min(trial.loss for trial in search.search(method, ranges, judge, H, 0))


def ours(known: list[TrueMotion], bits: int, names: list[str]) -> list[Score]:
    """The methods of scarid."""
    scores = []
    for name in names:
        score = Score(name, class_of(DIFFERENTIATORS.load(name)()), bits, ours=True)
        for seed, motion in enumerate(known):
            q = seen(motion.q, bits, seed)
            method = blind(name, q)
            sensor = partial(derivatives, method)
            score.measure(sensor, motion, seed)
            score.disturb(sensor, motion, seed)
            score.informed.append(informed(method, q, motion))
        score.cost = cost(method, q)
        scores.append(score)
        print(f"  {bits} bit  {name:18} {score.total:7.2f}", flush=True)
    return scores


# From the number of a motion to the ways of running a peer on it.
Maker = Callable[[int], list[peers.Sensor]]


def makers(positions: list[Array]) -> list[tuple[str, str, Maker]]:
    """Name, class and tuning of each peer, from the positions of all motions.

    A PyNumDiff method is tuned by its `optimize` on the first motion of each kind.
    """
    found = peers.present()
    made: list[tuple[str, str, Maker]] = []
    if found["AlgDiff"]:
        made.append(("AlgDiff", CLASSES[0], lambda k: [peers.tuned_algdiff(positions[k])]))
        made.append(("AlgDiff, shifted", CLASSES[1], lambda k: [_shifted(positions[k])]))
    if found["derivative"]:
        for name, (kind, settings) in peers.DERIVATIVE.items():
            sensor = peers.derivative(kind, settings)
            made.append((name, CLASSES[2], lambda _, sensor=sensor: [sensor]))
    if found["pynumdiff"]:

        @cache
        def optimised(name: str, kind: int) -> list[peers.Sensor]:
            return list(peers.pynumdiff(name, positions[2 * kind]))

        made += [
            (f"pynumdiff {name}", CLASSES[2], lambda k, name=name: optimised(name, k // 2))
            for name in peers.SPACES
        ]
    return made


def _shifted(q: Array) -> peers.Sensor:
    return peers.shifted(peers.tuned_algdiff(q), q)


def others(known: list[TrueMotion], bits: int) -> list[Score]:
    """The peers; each is run in the way that gives it the smaller error of the acceleration."""
    scores = []
    for name, kind, make in makers([seen(motion.q, bits, k) for k, motion in enumerate(known)]):
        try:
            candidates = tried(partial(Score, name, kind, bits, ours=False), make, known)
        except Exception as error:  # a peer that fails is reported, and the run goes on
            print(f"  {name}: {type(error).__name__}: {error}"[:100])
            continue
        scores.append(min(candidates, key=lambda score: geometric(score.a)))
        print(f"  {bits} bit  {name:22} {scores[-1].total:7.2f}", flush=True)
    return scores


def tried(empty: Callable[[], Score], make: Maker, known: list[TrueMotion]) -> list[Score]:
    """A score for each way of running a peer."""
    scores: list[Score] = []
    step = 2 if empty().name.split()[-1] in peers.SLOW else 1  # one motion of each kind
    for seed, motion in list(enumerate(known))[::step]:
        sensors = make(seed)
        scores = scores or [empty() for _ in sensors]
        for score, sensor in zip(scores, sensors, strict=True):
            score.measure(sensor, motion, seed)
            if score.kind != CLASSES[2]:  # those of the whole record take minutes for a minute
                score.disturb(sensor, motion, seed)
    return scores


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    names = DIFFERENTIATORS.names
    parser.add_argument("methods", nargs="*", help="of scarid, for a table alone (default: all)")
    parser.add_argument("--no-peers", action="store_true", help="leave out other packages")
    parser.add_argument(
        "--output", type=Path, default=Path("build/differentiators"), help="folder of the figures"
    )
    options = parser.parse_args()
    missing = [name for name, there in peers.present().items() if not there]
    if missing:
        print(f"Not installed, so left out: {', '.join(missing)}")
    known, scores = motions(), []
    for bits in summary.BITS:
        scores += ours(known, bits, options.methods or names)
        scores += [] if options.no_peers else others(known, bits)
    summary.tables(scores)
    if options.methods:
        return
    summary.claims(scores)
    summary.draw(scores, options.output)
    print(f"\nFigures: {options.output}")


if __name__ == "__main__":
    main()
