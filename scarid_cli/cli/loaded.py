"""The loaded robot of `scarid payload` and `gains`: the parameters of its logs."""

from __future__ import annotations

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.cli.job import Job
from scarid_cli.cli.logs import read_logs
from scarid_cli.cli.measured import read, searching
from scarid_cli.io.table import Table
from scarid_cli.stages import blind

PARAMETERS = ("parameter", "estimate")  # columns of a table of parameters


def loaded(job: Job, files: tuple[str, ...], robot: str | None, arm: Robot) -> Table:
    """The parameters of the loaded robot: a table of them, or what its logs give."""
    if len(files) == 1 and _is_parameters(job, files[0]):
        return job.read(files[0], "parameters")
    logs, arm = read_logs(job, files, robot or arm.name, lambda file, own: read(job, file, own))
    result = blind.identified(logs, arm, progress=searching(job))
    verdict, reasons = result.meta.extra["verdict"], result.meta.extra["reasons"]
    job.say(f"the loaded robot: {verdict}: {reasons[0]}")
    return result


def _is_parameters(job: Job, file: str) -> bool:
    source = job.opened(file)
    start = source.peek_lines(1) if not source.peek(4).startswith((b"PAR1", b"ARRO")) else b""
    if start:
        return start.startswith(b"parameter,")
    import pyarrow.parquet as pq

    return file.endswith(".parquet") and {*PARAMETERS} <= {*pq.read_schema(file).names}
