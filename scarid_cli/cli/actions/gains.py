"""Run `scarid gains`."""

from __future__ import annotations

from scarid_cli.cli.running.job import Job
from scarid_cli.cli.running.loaded import loaded
from scarid_cli.errors import UsageFault
from scarid_cli.interval import HALF
from scarid_cli.stages import gains as stage
from scarid_cli.stages.records.corrected import gains_of
from scarid_cli.stages.results.documents import of_gains


def run(
    job: Job,
    *,
    files: tuple[str, ...],
    parameters: str,
    mass: str,
    centre: str | None,
    frame: str | None,
    robot: str | None,
    toml: str | None,
    as_json: bool,
) -> None:
    """Write the table of the gains, and say which torque constants are wrong."""
    (kg,), error = _stated("--mass", mass, 1)
    if not kg > 0.0:
        raise UsageFault(f"--mass {mass}: a mass is positive")
    place = _stated("--centre", centre, 3) if centre else None
    lines = job.side_text(toml)
    bare = job.read(parameters, "parameters")
    arm = job.robot(robot, bare)
    load = stage.load_in(arm, frame, (kg, error), place)
    other = loaded(job, files, robot, arm, gains_of(bare))
    found = stage.gains(bare, other, arm, load)
    result = stage.table(found, arm, bare, other)
    if lines:
        lines.write(stage.toml_lines(found))
    job.write_or_print(job.recorded(result), of_gains if as_json else None)
    for line in stage.told(found):
        job.say(line)
    if not found.known.all() and (remedy := stage.freed(bare)):
        job.say(f"more may be told: {remedy}")


def _stated(option: str, text: str, count: int) -> tuple[list[float], float]:
    """The numbers of `NUMBER,...[+-ERROR]`, and the standard error."""
    numbers, _, half = text.partition("+-")
    try:
        found = [float(part) for part in numbers.split(",")]
        error = float(half or "0") / HALF
    except ValueError:
        found, error = [], -1.0
    if len(found) != count or not all(map(_finite, found)) or not 0.0 <= error < 1e6:
        shape = "2+-0.01" if count == 1 else "0,0,0.1+-0.002"
        raise UsageFault(f"{option} {text}: write it as {shape}")
    return found, error


def _finite(x: float) -> bool:
    return abs(x) < 1e6
