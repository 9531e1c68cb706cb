"""Run `scarid convert`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from scarid_cli.cli.job import Job
from scarid_cli.cli.pairs import pair, renamings
from scarid_cli.errors import UsageFault
from scarid_cli.io.bags import bag_extension
from scarid_cli.io.bytesource import ByteSource
from scarid_cli.io.foreign import ARCHIVES, TranslatedCsv, read_archive
from scarid_cli.io.table import Table
from scarid_cli.stages.adapt import adapted

if TYPE_CHECKING:
    from scarid_cli.algorithms.robots.description import Robot


def run(
    job: Job,
    *,
    file: str,
    mappings: tuple[str, ...],
    units: tuple[str, ...],
    rate: float | None,
    robot: str | None,
    topic: str | None,
    torque_topic: str | None,
    join: str,
    joints: str,
    separator: str,
    decimal_comma: bool,
    header: str,
) -> None:
    """Write the table with its new names, units and clock."""
    _require_valid(rate, separator, decimal_comma=decimal_comma)
    names = renamings(mappings)
    given = [pair(text, "--unit") for text in units]
    arm = _robot(robot)
    source = job.opened(file)
    extension = bag_extension(file, source)
    if extension is None:
        table = _table(job, file, source, Notation(separator, header, decimal_comma))
    else:
        from scarid_cli.cli.recordings import Choice, read_recording  # not needed otherwise

        choice = Choice(topic, torque_topic, join, tuple(joints.split(",")) if joints else ())
        table = read_recording(job, file, source, extension, choice, arm)
    if arm:
        from scarid_cli.stages.joints import as_described

        table = as_described(table, arm, names, given, rate)
    else:
        table = adapted(table, names, given, rate)
    job.write(job.recorded(table))


def _robot(name: str | None) -> Robot | None:
    if not name:
        return None
    from scarid_cli.algorithms.robots.reading import load  # its reader is not needed otherwise

    return load(name)


def _require_valid(rate: float | None, separator: str, *, decimal_comma: bool) -> None:
    if rate is not None and not 0.0 < rate < float("inf"):
        raise UsageFault(f"--rate must be positive, not {rate:g}")
    if len(separator) > 1 and separator != "\\t":
        raise UsageFault(f"--separator is one character, not {separator!r}")
    if decimal_comma and not separator:
        raise UsageFault("--decimal-comma needs a --separator other than the comma")


@dataclass(frozen=True)
class Notation:
    """What the command line says about the CSV."""

    separator: str
    header: str
    decimal_comma: bool


def _table(job: Job, file: str, source: ByteSource, notation: Notation) -> Table:
    if file.endswith(ARCHIVES):
        return read_archive(file)
    if not notation.separator and not notation.header:
        return job.read_source(source)
    mark = "\t" if notation.separator == "\\t" else notation.separator
    comma = "," if notation.decimal_comma else ""
    return job.read_source(TranslatedCsv(source, mark, comma, notation.header))
