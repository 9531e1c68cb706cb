"""Logs in files as `convert` takes them: how they are written, who wrote them, what is told."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from scarid_cli.cli.running.job import Job
from scarid_cli.io.bytesource import ByteSource, unpacked
from scarid_cli.io.echoed_yaml import is_echoed, read_echoed
from scarid_cli.io.foreign import ARCHIVES, TranslatedCsv, read_archive
from scarid_cli.io.jsonio import is_json, read_json
from scarid_cli.io.notation import Notation, notation_of
from scarid_cli.io.roles import role_of
from scarid_cli.io.table import Table
from scarid_cli.stages.conversion.cells import in_their_order
from scarid_cli.stages.conversion.recorders import expanded, recognised, units_in_names
from scarid_cli.stages.conversion.seconds import clock_columns, with_one_clock
from scarid_cli.stages.conversion.side import as_role, flattened, side_by_side, texts_flattened
from scarid_cli.stages.conversion.units import known_unit
from scarid_cli.stages.conversion.wording import Unclear, in_short, in_words
from scarid_cli.words import listed

if TYPE_CHECKING:
    from scarid_cli.algorithms.robots.description import Robot

BINARY = (b"PAR1", b"ARRO", b"\xff\xff\xff\xff")


@dataclass(frozen=True)
class Columns:
    """How the columns of a log are renamed: the old name of each new one, and their units."""

    names: dict[str, str]
    units: list[tuple[str, str]]


def read_log(
    job: Job, file: str, source: ByteSource, given: Notation | None, beside: Sequence[str],
    *, named: Collection[str],
) -> Table:  # fmt: skip
    """A log and those that lie beside it; reports how they are written.

    `named` are the columns that are renamed.
    """
    table = _one_clock(job, _read(job, file, source, given, named), named)
    for other in beside:
        apart = replace(given, header=()) if given else None
        role, path = role_of(other)
        found = _read(job, path, job.opened(path), apart, named)
        table = side_by_side(table, as_role(found, role, table.columns) if role else found)
    return table


def _read(
    job: Job, file: str, source: ByteSource, given: Notation | None, named: Collection[str]
) -> Table:
    if file.endswith(ARCHIVES):
        table, left_out, singles = read_archive(file, named, given.header if given else ())
        if left_out:
            job.notes.append(f"{file}: left out {', '.join(left_out)}, which --map does not name")
        if singles:
            job.notes.append(f"{file}: single numbers are left out: {', '.join(singles)}")
        return table
    source = unpacked(source)
    if source.peek(4).startswith(BINARY):
        return flattened(job.read_source(source))
    if is_json(source):
        return read_json(source)
    if is_echoed(source):
        return read_echoed(source, job.notes.append)
    notation = notation_of(source, given, by_name=bool(named))
    if notation.units:
        notation = _with_units(notation)
    if notation.plain:
        return texts_flattened(job.read_source(source))
    if not (given and given.separator):
        job.notes.append(f"{source.name}: read with {notation.text}")
    return texts_flattened(job.read_source(TranslatedCsv(source, notation)))


def _with_units(notation: Notation) -> Notation:
    """The notation whose names have the units that stand below them, as far as these are known."""
    pairs = zip(notation.header, notation.units, strict=True)
    header = [f"{name} [{unit}]" if known_unit(unit) else name for name, unit in pairs]
    return replace(notation, header=tuple(header))


def _one_clock(job: Job, table: Table, named: Collection[str]) -> Table:
    """The table with one clock, where seconds and their fraction are in columns of their own."""
    columns = None if "t" in table.columns else clock_columns(table.columns)
    if columns is None or not {*columns[:2]}.isdisjoint(named):
        return table
    job.notes.append(f"the time is that of {columns[0]} and {columns[1]}, from 0")
    return with_one_clock(table, columns)


def columns_of(
    job: Job, table: Table, pairs: dict[str, str], units: list[tuple[str, str]], wanted: str | None,
    robot: Robot | None, joints: Sequence[str], cells: Sequence[str] = (),
) -> Columns:  # fmt: skip
    """The columns as the options, the recorder, and the words in names say, in this order.

    The names of joints in `cells` tell the order of arrays.
    """
    order = joints or (robot.body.joint_names if robot and robot.body else ())
    arrays = expanded({n: o for n, o in pairs.items() if "*" in n}, table.columns, table.name)
    singles = expanded({n: o for n, o in pairs.items() if "*" not in n}, table.columns, table.name)
    names = {**_by_cells(job, arrays, cells, order), **singles}
    found = recognised(table.columns, wanted, order, table.name)
    described = {**robot.log.columns} if robot and robot.log else {}
    taken = {*names.values(), *described.values()}
    if found:
        own = _with_torques(found.columns, robot)
        joints_found = f", joints {', '.join(found.joints)}" if found.joints else ""
        job.notes.append(f"columns of {found.name}{joints_found}")
        own = _by_cells(job, own, cells, order)
        _tell_of_currents(job, own)
        own = {new: old for new, old in own.items() if old not in taken and new not in names}
        known = [(new, unit) for new, unit in found.units if new in own]
        return Columns({**own, **names}, [*known, *units])
    left = [column for column in table.columns if column not in taken]
    in_cells = {*order} <= {*cells}
    worded, known = _in_words(job, table, left, {*names, *described}, () if in_cells else order)
    worded = _by_cells(job, worded, cells, order)
    worded = _with_torques(worded, robot)
    _tell_of_currents(job, worded)
    known = [(new, unit) for new, unit in known if new in worded]
    inside = units_in_names(
        [c for c in left if c not in worded.values()] + [*names.values()], names
    )
    for old, (new, unit) in inside.items():
        job.notes.append(f"column {old!r} becomes {new}, from {unit} as its name says")
    return Columns({**worded, **{new: old for old, (new, _) in inside.items()}, **names},
                   [*known, *inside.values(), *units])  # fmt: skip


def _in_words(
    job: Job, table: Table, left: list[str], given: set[str], joints: Sequence[str]
) -> tuple[dict[str, str], list[tuple[str, str]]]:
    """The columns that the words in their names tell, and their units; says which these are."""
    try:
        found = None if table.meta.kind else in_words(left, given, joints)
    except Unclear as why:
        job.notes.append(f"columns keep their names, because {why}: rename them with --map")
        found = None
    if not found:
        return {}, []
    job.notes.append(f"columns by the words in their names: {in_short(found)}")
    if found.left_out and not joints:
        job.notes.append(f"left alone, as there is no torque of them: {', '.join(found.left_out)}")
    if found.joints and not joints:
        job.notes.append("joints in the order of their columns (another: --joints)")
    return found.columns, [*found.units]


def _by_cells(
    job: Job, columns: dict[str, str], cells: Sequence[str], order: Sequence[str]
) -> dict[str, str]:
    """The columns of arrays in the order of the joints, whose names stand in the cells."""
    if not cells or not columns:
        return columns
    found = in_their_order(columns, cells, order) if order else columns
    note = f"joints as the log names them: {', '.join(cells)} (another order: --joints)"
    unknown = [joint for joint in order if joint not in cells]
    if unknown:
        note += f"; as none is {listed(unknown)} of the robot, only their places count"
    elif order:
        note = f"put in the order {', '.join(order)}: the log has {', '.join(cells)}"
    if (found != columns or unknown or not order) and note not in job.notes:
        job.notes.append(note)
    return found


def _with_torques(columns: dict[str, str], robot: Robot | None) -> dict[str, str]:
    """The columns; currents of motors are called tau if the robot's description converts them."""
    if not (robot and robot.log and robot.log.torques == "current"):
        return columns
    return {new.replace("current", "tau"): old for new, old in columns.items()}


def _tell_of_currents(job: Job, columns: dict[str, str]) -> None:
    if any(new.startswith("current") for new in columns):
        job.notes.append(
            "currents stay currents [A]: --robot FILE makes them torques, if its description has "
            'torques = "current" in [log] and a torque_constant for each joint (docs/robots.md)'
        )
