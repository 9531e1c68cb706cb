"""The logs of a robot that stand for the others."""

from __future__ import annotations

import numpy as np
from steps.plan import Log
from steps.reference import POOLED, Entry, _nearest, others


def entries(values: list[float], verdicts: list[str] | None = None) -> list[Entry]:
    """Logs with one parameter of this value."""
    given = verdicts or ["good"] * len(values)
    return [
        (
            Log(str(k), f"{k}.csv", None, k + 1),
            {
                "check": "ok",
                "verdict": verdict,
                "estimates": [{"parameter": "Fs1", "estimate": value, "robust_error": 0.01}],
            },
        )
        for k, (value, verdict) in enumerate(zip(values, given, strict=True))
    ]


def names(listed: list[Entry]) -> list[int]:
    return [int(log.name) for log in _nearest(listed)]


def test_a_minority_of_changed_logs_does_not_stand_for_the_others() -> None:
    rng = np.random.default_rng(1)
    for count in (5, 9, 12, 40):
        changed = (count - 1) // 2
        values = (1.0 + 0.01 * rng.normal(size=count)).tolist()
        values[:changed] = (2.0 + 0.01 * rng.normal(size=changed)).tolist()
        chosen = names(entries(values))
        assert min(chosen) >= changed
        assert len(chosen) == min(POOLED, count // 2) + 1


def test_those_of_a_drift_are_from_its_middle() -> None:
    chosen = names(entries(np.linspace(1.0, 2.0, 41).tolist()))
    assert all(abs(k - 20) <= POOLED // 2 + 1 for k in chosen)


def test_logs_with_the_best_verdict_come_first() -> None:
    values = [1.0, 1.1, 1.2, 1.11, 1.09]
    assert names(entries(values, ["doubtful", "good", "good", "doubtful", "doubtful"])) == [1, 2]
    assert len(names(entries(values[:1]))) == 1


def test_a_log_is_not_validated_against_itself() -> None:
    listed = entries([1.0, 1.01, 0.99, 1.02, 0.98, 1.03, 0.97])
    against = {"nearest": [log.name for log in _nearest(listed)]}
    for log, _ in listed:
        chosen = others(against, log)
        assert log.name not in chosen
        assert len(chosen) == len(against["nearest"]) - 1 == 3
