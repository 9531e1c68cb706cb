"""Run `scarid resample`."""

from __future__ import annotations

from scarid_cli.algorithms.processes.resampling import Clock
from scarid_cli.cli.running.job import Job
from scarid_cli.errors import UsageFault
from scarid_cli.stages import resample as stage


def run(job: Job, *, file: str, rate: float, max_gap: float | None, robot: str | None) -> None:
    """Write the log at a constant rate, and report what its clock did."""
    for name, value in (("--rate", rate), ("--max-gap", max_gap)):
        if value is not None and not 0.0 < value < float("inf"):
            raise UsageFault(f"{name} must be positive, not {value:g}")
    table = job.recorded(job.read(file, "measurement", regular=False, robot=robot))

    def report(clock: Clock) -> None:
        job.say(summary_line(clock))
        job.doubt_rate(clock.mean)

    job.write(stage.resample(table, rate, max_gap, report))


def summary_line(clock: Clock) -> str:
    """Mean rate, jitter, longest interval, repeated rows and gaps of a clock."""
    gaps = "no gap"
    if clock.gaps:
        gaps = f"{clock.gaps} gap{'s' if clock.gaps > 1 else ''} of {clock.missing:.3g} s in all"
    line = (
        f"{1.0 / clock.mean:.6g} Hz on average, jitter {1e3 * clock.jitter:.3g} ms, "
        f"longest interval {1e3 * clock.longest:.3g} ms, {clock.repeated} repeated rows, {gaps}"
    )
    if clock.held:
        held = "1 held sample" if clock.held == 1 else f"{clock.held:,} held samples"
        line += f"; left out {held} (rows that repeat all measured values)"
    for name, interval, count in clock.filled:
        line += f"; {name} are new every {1e3 * interval:.3g} ms only, interpolated {count:,} rows"
    return line
