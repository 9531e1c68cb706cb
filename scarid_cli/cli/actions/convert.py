"""Run `scarid convert`."""

from __future__ import annotations

from fnmatch import fnmatchcase
from typing import TYPE_CHECKING

from scarid_cli.algorithms.robots.logs import CURRENT
from scarid_cli.cli.declaring.pairs import pair, renamings
from scarid_cli.cli.running.job import Job
from scarid_cli.cli.running.texts import Columns, columns_of, read_log
from scarid_cli.errors import UsageFault
from scarid_cli.io.bags import bag_extension
from scarid_cli.io.notation import Notation
from scarid_cli.io.schemas import numbered
from scarid_cli.io.table import Table
from scarid_cli.stages.conversion.adapt import adapted
from scarid_cli.stages.conversion.cells import names_in_cells
from scarid_cli.stages.conversion.lacking import lacking
from scarid_cli.stages.conversion.recorders import unstated_unit
from scarid_cli.stages.conversion.side import episodes_joined
from scarid_cli.stages.conversion.turns import one_row_for_all, refuse_long
from scarid_cli.stages.conversion.units import is_stated, unit_option
from scarid_cli.stages.conversion.wording import current_as_torque
from scarid_cli.stages.records.runs import runs_joined

if TYPE_CHECKING:
    from scarid_cli.algorithms.robots.description import Robot

EPISODE = "episode_index"  # the column of LeRobot's data sets


def run(
    job: Job,
    *,
    file: str,
    beside: tuple[str, ...],
    mappings: tuple[str, ...],
    units: tuple[str, ...],
    rate: float | None,
    robot: str | None,
    recorder: str | None,
    topic: str | None,
    torque_topic: str | None,
    join: str,
    joints: str,
    separator: str,
    decimal_comma: bool,
    header: str,
    unwrap: bool,
    despike: bool,
) -> None:
    """Write the table with its new names, units and clock."""
    _require_valid(separator, decimal_comma=decimal_comma)
    pairs = renamings(mappings)
    given = [pair(text, "--unit") for text in units]
    arm = _robot(job.described(robot)) if robot else None
    order = tuple(joints.split(",")) if joints else ()
    source = job.opened(file)
    extension = bag_extension(file, source)
    if extension is None:
        notation = _notation(separator, header, decimal_comma=decimal_comma)
        table = read_log(job, file, source, notation, beside, named=pairs.values())
        refuse_long(table)
        table, turns = one_row_for_all(table, job.notes.append)
        table, names = names_in_cells(table)
        columns = columns_of(job, table, pairs, given, recorder, arm, order, turns or names)
        _require_units(pairs, columns, arm)
        clock = rate or (arm and arm.log and arm.log.rate)
        _tell_lacking(job, table, columns, arm, clock=bool(clock))
    else:
        from scarid_cli.cli.running.recordings import Choice, read_recording  # not needed otherwise

        choice = Choice(topic, torque_topic, join, order)
        table = read_recording(job, file, source, extension, choice, arm)
        columns = Columns(pairs, given)
    if unwrap or despike:
        from scarid_cli.stages.conversion.leaps import without_leaps

        read = _signals(table, columns, arm)
        table = without_leaps(table, read, unwrap=unwrap, despike=despike, report=job.notes)
    job.say_notes()  # before a next command may end the pipe for what is noted
    result = runs_joined(_adapted(table, columns, rate, arm), job.say)
    job.write(job.recorded(job.within(result)))


def _adapted(table: Table, columns: Columns, rate: float | None, robot: Robot | None) -> Table:
    if robot:
        from scarid_cli.stages.conversion.joints import as_described

        table = as_described(table, robot, columns.names, columns.units, rate)
    else:
        table = adapted(table, columns.names, columns.units, rate)
    return episodes_joined(table, EPISODE)


def _require_units(pairs: dict[str, str], columns: Columns, robot: Robot | None) -> None:
    """Refuse a column whose name states a unit that is none of ours, unless it is stated.

    And to call a current a torque, unless its torque constant is.
    """
    constants = robot and robot.log and robot.log.torques == CURRENT
    mapped = {n: o for n, o in columns.names.items() if any(fnmatchcase(n, p) for p in pairs)}
    for new, old in mapped.items():
        if is_stated(new, columns.units):
            continue
        if not constants and current_as_torque(new, old):
            raise UsageFault(
                f"--map {new}={old}: by its name a current and no torque; state what one ampere "
                f"gives, as in --unit '{new}=0.05 N m', or call it current{new[3:]}"
            )
        if numbered([new], "q", "dq", "tau", "current") and (unit := unstated_unit(old)):
            raise UsageFault(
                f"--map {new}={old}: its name does not say what one {unit} is; state it, as in "
                f"{unit_option(new)}"
            )


def _tell_lacking(
    job: Job, table: Table, columns: Columns, robot: Robot | None, *, clock: bool
) -> None:
    """Say which positions, torques or clock a raw log lacks, and which columns may hold them."""
    if table.meta.kind:
        return
    described = robot.log.columns if robot and robot.log else {}
    old = {*columns.names.values()}
    kept = [name for name in table.columns if name not in old]
    text = lacking(kept, [*columns.names, *described], clock=clock)
    if text:
        job.notes.append(text)


def _signals(table: Table, columns: Columns, robot: Robot | None) -> list[str]:
    """The columns of the log that hold positions and torques."""
    described = robot.log.columns if robot and robot.log else {}
    names = {**dict(zip(table.columns, table.columns, strict=True)), **described, **columns.names}
    found = (old for new, old in names.items() if numbered([new], "q", "tau"))
    return [old for old in dict.fromkeys(found) if old in table.columns]


def _notation(separator: str, header: str, *, decimal_comma: bool) -> Notation | None:
    """What the command line says about the notation, if anything."""
    if not separator and not header:
        return None
    mark = "\t" if separator == "\\t" else separator
    return Notation(mark, decimal_comma, tuple(header.split(",")) if header else ())


def _robot(name: str) -> Robot:
    from scarid_cli.algorithms.robots.reading import load  # its reader is not needed otherwise

    return load(name)


def _require_valid(separator: str, *, decimal_comma: bool) -> None:
    if len(separator) > 1 and separator != "\\t":
        raise UsageFault(f"--separator is one character, not {separator!r}")
    if decimal_comma and not separator:
        raise UsageFault("--decimal-comma needs a --separator other than the comma")
