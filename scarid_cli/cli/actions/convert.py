"""Run `scarid convert`."""

from __future__ import annotations

from scarid_cli.algorithms.robots.reading import load
from scarid_cli.cli.job import Job
from scarid_cli.cli.pairs import pair, renamings
from scarid_cli.errors import UsageFault
from scarid_cli.io.bytesource import ByteSource
from scarid_cli.io.foreign import ARCHIVES, TranslatedCsv, read_archive
from scarid_cli.io.table import Table
from scarid_cli.stages.adapt import adapted
from scarid_cli.stages.joints import as_described


def run(
    job: Job,
    *,
    file: str,
    mappings: tuple[str, ...],
    units: tuple[str, ...],
    rate: float | None,
    robot: str | None,
    separator: str,
    decimal_comma: bool,
    header: str,
) -> None:
    """Write the table with its new names, units and clock."""
    _require_valid(rate, separator, decimal_comma=decimal_comma)
    names = renamings(mappings)
    given = [pair(text, "--unit") for text in units]
    table = _opened(job, file, separator, header, decimal_comma=decimal_comma)
    if robot:
        table = as_described(table, load(robot), names, given, rate)
    else:
        table = adapted(table, names, given, rate)
    job.write(job.recorded(table))


def _require_valid(rate: float | None, separator: str, *, decimal_comma: bool) -> None:
    if rate is not None and not 0.0 < rate < float("inf"):
        raise UsageFault(f"--rate must be positive, not {rate:g}")
    if len(separator) > 1 and separator != "\\t":
        raise UsageFault(f"--separator is one character, not {separator!r}")
    if decimal_comma and not separator:
        raise UsageFault("--decimal-comma needs a --separator other than the comma")


def _opened(job: Job, file: str, separator: str, header: str, *, decimal_comma: bool) -> Table:
    if file.endswith(ARCHIVES):
        return read_archive(job.noted(file))
    if not separator and not header:
        return job.read(file, None)
    mark = "\t" if separator == "\\t" else separator
    comma = "," if decimal_comma else ""

    def through(source: ByteSource) -> ByteSource:
        return TranslatedCsv(source, mark, comma, header)

    return job.read(file, None, through=through)
