"""The clock: rate, jitter, gaps, repeated times, and rows that repeat the one before."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.checks.finding import Finding, failed, ok, several, warning
from scarid_cli.algorithms.checks.log import Log
from scarid_cli.algorithms.processes.coarse import Ticks
from scarid_cli.algorithms.processes.filling import reading_interval
from scarid_cli.algorithms.processes.holding import MAX_GAP, TOGETHER
from scarid_cli.algorithms.processes.rates import lost_rows, mean_rate
from scarid_cli.algorithms.processes.resolution import resolution_of
from scarid_cli.arrays import Array, Marks, median

# Hz. Friction and inertia are told apart where the velocity changes within tenths of a second. Logs
# of a few rows in each give the right parameters, but far less exactly; one of fewer rows is of no
# use, and one of more than the highest rate is no log of joints.
LOWEST, SLOW, HIGHEST = 5.0, 20.0, 200_000.0
LONGER = ((86400.0, "days, as Excel counts them"), (3600.0, "hours"), (60.0, "minutes"))
UNITS = ((1e3, "ms"), (1e6, "us"), (1e9, "ns"))  # of a time that is not in seconds
FASTER = "record at 100 Hz or more"
JITTER = 0.01  # of the period: the limit of `differentiate`, as io.clock has it
ROUNDING = 1e-6  # of the period: the digits of the time
GAP = MAX_GAP  # periods
LEAP = 1.5  # steps of the resolution: more than one, in spite of rounding
HELD = 0.001  # of the rows: from one in a thousand on, the velocity has visible steps


@dataclass(frozen=True)
class Clock:
    """The intervals of a log [s] and their median, the period [s]."""

    steps: Array
    period: float

    @classmethod
    def of(cls, t: Array, segment: Array | None = None) -> Clock:
        """The clock of the rows at these times, without the gaps between known segments (rows)."""
        known = np.isfinite(t)
        steps = np.diff(t[known])
        if segment is not None:
            steps = steps[np.diff(segment[known]) == 0.0]
        forward = steps[steps > 0.0]
        return cls(steps, median(forward) if len(forward) else 0.0)

    @property
    def rate(self) -> float:
        """Rows per second, as a mean over the log without its gaps."""
        return mean_rate(self.steps)


def unit(clock: Clock) -> tuple[Finding, float]:
    """The rate, and the factor that brings the time to seconds (1 if it is in seconds)."""
    figure = f"{clock.rate:.6g} Hz"
    if not clock.period:
        return failed("rate", "the time never increases", "give a log with a clock"), 1.0
    if clock.rate > HIGHEST:
        for factor, name in LONGER:
            if SLOW <= clock.rate / factor <= HIGHEST:
                advice = f"the time seems to be in {name}: `scarid convert --unit 't={factor:g} s'`"
                return failed("rate", f"{figure} if t is in seconds", advice), factor
        return failed("rate", figure, "the time is not in seconds: convert the unit of t"), 1.0
    if clock.rate >= SLOW:
        return ok("rate", figure), 1.0
    if clock.rate >= LOWEST:
        return warning("rate", figure, FASTER), 1.0
    for factor, name in UNITS:
        if SLOW <= factor * clock.rate <= HIGHEST:
            advice = f"the time seems to be in {name}: `scarid convert --unit t={name}`"
            return failed("rate", f"{figure} if t is in seconds", advice), 1.0 / factor
    return failed("rate", figure, FASTER), 1.0


def clock(found: Clock, resampling: str) -> list[Finding]:
    """Findings on gaps and jitter.

    `resampling` is the command that mends what can be mended.
    """
    steps, period = found.steps, found.period
    if not period:
        return []
    return [
        _gaps(steps, period, resampling),
        _jitter(steps[(steps > 0.0) & (steps <= GAP * period)], period, resampling),
    ]


def order(log: Log) -> Finding:
    """Time that goes back, and repeated times."""
    steps = np.diff(log.t[np.isfinite(log.t)])
    back, repeated = np.count_nonzero(steps < 0.0), np.count_nonzero(steps == 0.0)
    if back:
        figure = f"time goes back in {several(int(back), 'place')}"
        if starts := log.run_starts:
            rows = ", ".join(str(start + 1) for start in starts)
            figure += f": {several(len(starts) + 1, 'run')}, begun again in row {rows}"
            split = log.in_order().resampling()
            advice = f"`scarid convert` puts them one after the other, {split} makes them segments"
        else:
            advice = "sort the log by time"
        return failed("time order", figure, advice)
    if repeated:
        return warning(
            "time order",
            several(int(repeated), "repeated time"),
            f"{log.resampling()} drops the rows that repeat a time",
        )
    return ok("time order", "time increases from row to row")


def ticks(log: Log) -> Ticks:
    """The ticks of the clock of a log in the order of its rows."""
    found = Ticks()
    if np.all(np.diff(log.t) >= 0.0):
        found.after(log.t, log.signals)
    return found


def coarse(found: Ticks) -> Finding:
    """What is found of a clock that is coarser than the rows."""
    return failed(
        "clock",
        f"{found.unlike:,} of {found.rows:,} rows have the time of the row before and other values",
        f"the clock is coarser than the rows: count them instead, {found.counting}",
    )


def _gaps(steps: Array, period: float, resampling: str) -> Finding:
    """Rows that are missing; long intervals split the log."""
    lost = lost_rows(steps, period)
    count, places = int(lost.sum()), int(np.count_nonzero(lost))
    if not count:
        return ok("missing rows", "none")
    long = int(np.count_nonzero(steps > GAP * period))
    figure = f"{several(count, 'row')} in {several(places, 'place')}, up to {steps.max():.3g} s"
    advice = f"{resampling} interpolates short gaps"
    advice += f" and splits the log at the {several(long, 'longer one')}" if long else ""
    return warning("missing rows", figure, advice)


def _jitter(steps: Array, period: float, resampling: str) -> Finding:
    """Intervals that differ from a whole number of periods; missing rows are not counted again."""
    whole = period * np.maximum(np.round(steps / period), 1.0)
    far = float(np.max(np.abs(steps - whole), initial=0.0))
    if far <= ROUNDING * period:
        return ok("jitter", "none")
    figure = f"at most {1e3 * far:.2g} ms, {100.0 * far / period:.2g} % of the period"
    if far <= JITTER * period:
        return ok("jitter", figure)
    return warning("jitter", figure, f"{resampling} gives a constant rate")


def held(log: Log) -> Finding:
    """Held samples, by the rule by which `resample` leaves them out."""
    rows, _ = log.held
    count = int(np.count_nonzero(rows))
    if not count:
        return ok("held samples", "none")
    share = f"{100.0 * count / log.rows:.2g} %"
    figure = f"{several(count, 'row')}, {share}, with all values of the row before"
    if _followed_by_leaps(log.sensed, rows) <= HELD * log.rows:
        return ok("held samples", figure)
    advice = f"a slower sensor behind a faster logger: {log.resampling()} keeps the first of each"
    return warning("held samples", figure, advice)


def _followed_by_leaps(values: Array, held: Marks) -> int:
    """How many of the `held` rows end with a change beyond the resolution of the values.

    Of half of the values (columns, rows) at least. Noise at rest changes them by one step.
    """
    starts, ends = np.flatnonzero(np.diff(held, prepend=False, append=False)).reshape(-1, 2).T
    ends = np.minimum(ends, len(held) - 1)
    changes = np.abs(np.diff(values, axis=1))
    steps = np.array([resolution_of(x) for x in values])
    leap = np.mean(changes[:, ends - 1] > LEAP * steps[:, None], axis=0) >= TOGETHER
    return int((ends - starts)[leap].sum())


def slower(log: Log) -> Finding:
    """Positions or torques of a sensor that is slower than the rows, by the rule of `resample`."""
    held, period = log.held
    t = log.t[~held]
    found = {
        name: interval
        for name, values in (("positions", log.q), ("torques", log.tau))
        if (interval := reading_interval(t, values[:, ~held]))
    }
    if not found:
        return ok("slower sensors", "none")
    figure = " and ".join(f"{name} are new every {1e3 * x:.3g} ms" for name, x in found.items())
    advice = f"{log.resampling()} interpolates between their readings"
    return warning("slower sensors", f"{figure} only, rows every {1e3 * period:.3g} ms", advice)
