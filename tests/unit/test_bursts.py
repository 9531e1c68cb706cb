"""Short intervals whose torques the model does not explain."""

from __future__ import annotations

import numpy as np
import pytest
from stages.tables import PERIOD, collected, table

from scarid_cli.algorithms.uncertainty.bursts import Interval, bursts
from scarid_cli.arrays import Array, Marks
from scarid_cli.stages.records.several import joined
from scarid_cli.stages.records.times import Times, advice

H, ROWS = 0.004, 5000
T = H * np.arange(ROWS)


def residual(kind: str, seed: int) -> tuple[Array, Array, Marks]:
    """Residual, torque, and rows that count (rows, 2) of a log without a collision."""
    rng = np.random.default_rng(seed)
    torque = 5.0 * np.sin(2.0 * np.outer(T, [1.0, 1.3]) + rng.uniform(0.0, 6.0, 2))
    noise = rng.standard_normal((ROWS, 2))
    smooth = np.array([np.convolve(x, np.hanning(50) / 5.0, "same") for x in noise.T]).T
    found = {
        "white": noise,
        "autocorrelated": smooth,
        "heavy tails": rng.standard_t(3.0, (ROWS, 2)),
        "in proportion to the torque": torque * smooth,
        "at reversals": smooth * (1.0 + 10.0 * (np.abs(torque) < 0.5)),
        "exact": 1e-9 * torque * noise**8,
        "a standstill": smooth * (T > 8.0)[:, None],
    }[kind]
    return found, torque, rng.random((ROWS, 2)) < 0.7


KINDS = [
    "white", "autocorrelated", "heavy tails", "in proportion to the torque", "at reversals",
    "exact", "a standstill",
]  # fmt: skip


@pytest.mark.parametrize("kind", KINDS)
def test_a_log_without_a_collision_has_no_burst(kind: str) -> None:
    for seed in range(20):
        r, y, counts = residual(kind, seed)
        assert bursts(0.2 * r, y, counts, T) == ()


@pytest.mark.parametrize("starts", [(7.3,), (0.9, 12.47)])
def test_a_collision_is_found_at_its_time(starts: tuple[float, ...]) -> None:
    for seed in range(20):
        r, y, counts = residual("autocorrelated", seed)
        for start in starts:
            r[(start <= T) & (start + 0.05 > T), 1] += 60.0
        found = bursts(0.2 * r, y, counts, T)
        assert [x.start for x in found] == pytest.approx(starts, abs=0.05)
        assert [x.end - 0.05 for x in found] == pytest.approx(starts, abs=0.05)


def test_a_payload_of_two_seconds_is_found_but_not_one_of_half_the_log() -> None:
    r, y, counts = residual("autocorrelated", 1)
    short, long = r.copy(), r.copy()
    short[(T > 6.0) & (T < 8.0), 0] += 60.0
    long[T > 10.0, 0] += 60.0
    (found,) = bursts(0.2 * short, y, counts, T)
    assert (found.start, found.end) == pytest.approx((6.0, 8.0), abs=0.05)
    assert bursts(0.2 * long, y, counts, T) == ()


@pytest.mark.parametrize(
    ("found", "options"),
    [
        ([(2.02, 2.11)], "at 2 to 2.2 s * with --from-time 2.2"),
        ([(8.0, 8.1)], "at 8 to 8.1 s * with --to-time 8"),
        (
            [(2.0, 2.1), (9.0, 9.1)],
            "at 2 to 2.1 s and 9 to * several logs * --from-time 2.1 --to-time 9",
        ),
    ],
)
def test_the_longest_part_without_a_burst_is_kept(
    found: list[tuple[float, float]], options: str
) -> None:
    text = advice([Interval(*x) for x in found], 0.0, 10.0)
    assert all(words in text for words in options.split(" * "))


def test_times_are_those_of_the_log_across_its_gaps() -> None:
    """The samples are counted on after a gap as if it took 0.05 s."""
    t = np.concatenate((3.0 + PERIOD * np.arange(500), 20.0 + PERIOD * np.arange(500)))
    log = table({"t": t, "segment": np.repeat([0, 1], 500)}, [300])
    times = Times(log, 0)
    collected(times.watched(log))
    after = 500 * PERIOD + 0.05 + 1.0  # s, one second into the second segment
    assert "at 4 to 4.1 s " in times.unexplained([Interval(1.0, 1.1)])
    assert "at 21 to 21.1 s " in times.unexplained([Interval(after + 0.01, after + 0.1)])


def test_several_logs_have_no_time_in_common() -> None:
    logs = [table({"t": 0.01 * np.arange(500.0), "q1": np.zeros(500)}) for _ in range(2)]
    whole = joined(logs)
    times = Times(whole, 0)
    collected(times.watched(whole))
    assert times.unexplained([Interval(1.0, 1.1)]) == ""
