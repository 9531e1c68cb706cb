"""The loaded robot of `scarid payload` and `gains`: the parameters of its logs."""

from __future__ import annotations

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.cli.running.job import Job
from scarid_cli.cli.running.logs import read_logs
from scarid_cli.cli.running.measured import read, searching
from scarid_cli.io.table import Table
from scarid_cli.stages.procedure import blind
from scarid_cli.stages.records.corrected import corrected

PARAMETERS = ("parameter", "estimate")  # columns of a table of parameters


def loaded(
    job: Job, files: tuple[str, ...], robot: str | None, arm: Robot, gains: list[float]
) -> Table:
    """The parameters of the loaded robot: a table of them, or what its logs give.

    The torques of logs are divided by the `gains` (joints) of the bare robot, if there are any.
    """
    files = files or ("-",)
    if len(files) == 1 and {*PARAMETERS} <= {*job.columns_of(files[0])}:
        return job.read(files[0], "parameters")
    logs, arm = read_logs(job, files, robot or arm.name, lambda file, own: read(job, file, own))
    logs = [corrected(log, gains) for log in logs] if gains else logs
    result = blind.identified(logs, arm, progress=searching(job), loaded=True)
    verdict, reasons = result.meta.extra["verdict"], result.meta.extra["reasons"]
    job.say(f"the loaded robot: {verdict}: {reasons[0]}")
    return result
