"""How well criteria that do not know the truth choose settings; see docs/design/signals.md.

For causal methods on quintic moves measured by encoders of 13 and 16 bit: the error with the
settings that a criterion chooses, over the error with those that the truth would choose. The
criteria are the distance to a smoother that tunes itself (`scarid tune`), and the error of
positions predicted some time ahead.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.algorithms.processes.delays import reference
from scarid_cli.algorithms.processes.matching import over
from scarid_cli.algorithms.tuning import judges, search
from scarid_cli.arrays import Array

H = 0.005
METHODS = ("p2smd", "2smd", "levant", "filtering", "high-gain", "savgol-end", "tracking", "ed-fir")
AHEAD = (0.02, 0.05, 0.1)
INNER = slice(200, -200)


def truth(q: Array, v: Array, a: Array) -> search.Judge:
    """The geometric mean of the NRMSE of velocity and of acceleration."""

    def judge(method: Any) -> float:
        with np.errstate(all="ignore"):
            errors = [
                np.std((x - y)[INNER]) / np.std(y[INNER])
                for x, y in zip(over(method, q, H), (v, a), strict=True)
            ]
            return float(np.sqrt(errors[0] * errors[1]))

    return judge


def prediction(q: Array, ahead: float) -> search.Judge:
    """Error of q + v T + a T^2 / 2 as a prediction of the position measured T later."""
    n = round(ahead / H)

    def judge(method: Any) -> float:
        with np.errstate(all="ignore"):
            v, a = over(method, q, H)
            predicted = q + ahead * v + 0.5 * ahead**2 * a
            return float(np.std((q[n:] - predicted[:-n])[INNER]))

    return judge


def main() -> None:
    q, v, a = reference(H)
    print("Error over that with settings chosen by the truth")
    names = ["smoother", *(f"{1e3 * ahead:.0f} ms ahead" for ahead in AHEAD)]
    print(f"{'':14}{''.join(f'{name:>14}' for name in names)}")
    for bits in (13, 16):
        step = 2.0 * np.pi / 2**bits
        noise = 0.3 * step * np.random.default_rng(bits).standard_normal(len(q))
        seen = step * np.round((q + noise) / step)
        right = truth(seen, v, a)
        candidates: list[Callable[[Any], float]] = [judges.distance_to_smoother(seen, H)]
        candidates += [prediction(seen, ahead) for ahead in AHEAD]
        for name in METHODS:
            method = DIFFERENTIATORS.load(name)()

            def chosen(judge: search.Judge, method: Any = method) -> Any:
                trials = search.search(method, method.TUNED, judge, H, 0)
                return min(trials, key=lambda trial: trial.loss).method

            least = right(chosen(right))
            ratios = [right(chosen(judge)) / least for judge in candidates]
            print(f"{bits} {name:11}{''.join(f'{ratio:14.2f}' for ratio in ratios)}")


if __name__ == "__main__":
    main()
