"""Names of columns: those of known recorders, patterns of renaming, and units within a name."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from scarid_cli.errors import UsageFault
from scarid_cli.io.schemas import column_type
from scarid_cli.stages.conversion.units import STRANGE, UNSTATED, known_unit

CURRENT = "current{i}"


@dataclass(frozen=True)
class Recorder:
    """The names that a program gives: its time column with the unit, and by our column its own.

    In the names, {k} is the number of a joint, from 0 or 1, {joint} its name, and * anything.
    """

    clock: str
    unit: str
    columns: dict[str, tuple[str, ...]]


RECORDERS = {
    # Recordings of Universal Robots' real-time interface, and the names that AURT expects.
    "ur-rtde": Recorder(
        "timestamp",
        "s",
        {
            "q{i}": ("actual_q_{k}",),
            "dq{i}_measured": ("actual_qd_{k}",),
            CURRENT: ("actual_current_{k}",),
            "q{i}_ref": ("target_q_{k}",),
            "dq{i}_ref": ("target_qd_{k}",),
            "ddq{i}_ref": ("target_qdd_{k}",),
        },
    ),
    "libfranka": Recorder(
        "time",
        "ms",
        {
            "q{i}": ("state.q[{k}]",),
            "dq{i}_measured": ("state.dq[{k}]",),
            "tau{i}": ("state.tau_J[{k}]",),
            "q{i}_ref": ("state.q_d[{k}]",),
            "dq{i}_ref": ("state.dq_d[{k}]",),
        },
    ),
    "plotjuggler": Recorder(
        "__time",
        "s",
        {
            "q{i}": ("*/{joint}/position", "*/position[{k}]", "*/position.{k}"),
            "dq{i}_measured": ("*/{joint}/velocity", "*/velocity[{k}]", "*/velocity.{k}"),
            "tau{i}": ("*/{joint}/effort", "*/effort[{k}]", "*/effort.{k}"),
        },
    ),
    "lerobot": Recorder(
        "timestamp",
        "s",
        {
            "q{i}": ("observation.state[{k}]",),
            "dq{i}_measured": ("observation.velocity[{k}]",),
            "tau{i}": ("observation.effort[{k}]", "observation.torque[{k}]"),
            CURRENT: ("observation.current[{k}]",),
            "q{i}_ref": ("action[{k}]",),
        },
    ),
    # The low-level state of Unitree's robots, whose torques are estimated from the currents.
    "unitree": Recorder(
        "tick",
        "ms",
        {
            "q{i}": ("*otor_state[{k}].q", "*otor_state_{k}_q", "*otorState[{k}].q"),
            "dq{i}_measured": ("*otor_state[{k}].dq", "*otor_state_{k}_dq", "*otorState[{k}].dq"),
            "tau{i}": (
                "*otor_state[{k}].tau_est",
                "*otor_state_{k}_tau_est",
                "*otorState[{k}].tauEst",
            ),
        },
    ),
}
OTHER_NAMES = {"aurt": "ur-rtde"}
MARK = re.compile(r"\{k\}|\{joint\}|\*")
PLACES = {"{k}": r"(?P<k>\d+)", "{joint}": r"(?P<joint>[^/]+)", "*": ".*"}


@dataclass(frozen=True)
class Recognised:
    """The recorder of a table: the old name of each new column, and the joints by their names.

    `left_out` are positions of what has no torque.
    """

    name: str
    columns: dict[str, str]
    units: tuple[tuple[str, str], ...]
    joints: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()


def recognised(
    names: Sequence[str], wanted: str | None, joints: Sequence[str], where: str
) -> Recognised | None:
    """The recorder whose columns these are: the `wanted` one, or the only one that fits.

    `joints` gives the order of joints with names, by default that of their columns. None if no
    recorder fits, or if the table has our own names.
    """
    if wanted:
        found = _fitting(OTHER_NAMES.get(wanted, wanted), names, joints, where)
        if found is None:
            own = RECORDERS[OTHER_NAMES.get(wanted, wanted)]
            raise UsageFault(
                f"{where}: --from {wanted} needs the columns {own.clock} and "
                f"{' or '.join(own.columns['q{i}']).replace('{k}', '0')}; it has "
                f"{', '.join(names)}"
            )
        return found
    if "q1" in names:
        return None
    fitting = [found for name in RECORDERS if (found := _fitting(name, names, joints, where))]
    if len(fitting) > 1:
        raise UsageFault(
            f"{where}: the columns fit {' and '.join(f.name for f in fitting)}; choose with --from"
        )
    return fitting[0] if fitting else None


def _fitting(
    name: str, names: Sequence[str], joints: Sequence[str], where: str
) -> Recognised | None:
    recorder = RECORDERS[name]
    if recorder.clock not in names:
        return None
    columns, order = {"t": recorder.clock}, tuple(joints)
    for new, patterns in recorder.columns.items():
        found = next((own for p in patterns if (own := _matching(p, names, where))), {})
        if new == "q{i}" and not found:
            return None
        if new == "q{i}" and not order:
            order = tuple(found)
        columns |= _numbered(new, found, order, where)
    units = [("t", recorder.unit), *((c, "A") for c in columns if c.startswith("current"))]
    named = not all(key.isdigit() for key in order)
    return Recognised(name, columns, tuple(units), order if named else ())


def _matching(pattern: str, names: Sequence[str], where: str) -> dict[str, str]:
    """The columns of a pattern, by the number or the name of their joint."""
    parts, places = MARK.split(pattern), MARK.findall(pattern)
    text = "".join(
        re.escape(part) + PLACES.get(place, "")
        for part, place in zip(parts, [*places, ""], strict=True)
    )
    found: dict[str, str] = {}
    for name in names:
        match = re.fullmatch(text, name)
        if match:
            key = next(iter(match.groupdict().values()))
            if key in found:
                raise UsageFault(
                    f"{where}: both {found[key]} and {name} could be that of joint {key}; choose "
                    f"with --map q1={name},..."
                )
            found[key] = name
    return dict(sorted(found.items(), key=lambda x: int(x[0]))) if "{k}" in pattern else found


def _numbered(
    new: str, found: dict[str, str], order: Sequence[str], where: str
) -> Iterator[tuple[str, str]]:
    """Our columns of the joints in this order."""
    if not found:
        return
    by_number = all(key.isdigit() for key in found)
    keys = list(found) if by_number else order
    for i, key in enumerate(keys, start=1):
        if key not in found:
            raise UsageFault(
                f"{where}: no column {new.replace('{i}', '')} of joint {key}; it has those of "
                f"{', '.join(found)}: name the joints in order with --joints"
            )
        yield new.replace("{i}", str(i)), found[key]


BRACKETS = re.compile(r"(?P<name>.*?)[\s_]*[\[(](?P<unit>[^\])]*)[\])]\s*")
SUFFIX = re.compile(r"(?P<name>.+)_(?P<unit>[^_]+)")
TIMES = ("time", "timestamp", "zeit", "temps", "tiempo", "tempo")  # of the clock, before a unit


def unit_in_name(column: str) -> tuple[str, str] | None:
    """From a name such as `q1 [deg]` or `time_ms` the name without the unit, and the unit."""
    match = _with_unit(column)
    unit = known_unit(match["unit"]) if match else None
    if not match or not unit:
        return None
    return "t" if match["name"].lower() in TIMES else match["name"], unit


def unstated_unit(column: str) -> str:
    """The unit in the name of a column that only its device knows, as %; empty if there is none."""
    match = UNSTATED.fullmatch(column) or STRANGE.fullmatch(column)
    return match[1] if match and not unit_in_name(column) else ""


def element(column: str, k: int) -> str:
    """The name of the k-th element of an array; a unit in the name of the array stays behind it."""
    match = _with_unit(column)
    end = match.end("name") if match else len(column)
    return f"{column[:end]}[{k}]{column[end:]}"


def _with_unit(column: str) -> re.Match[str] | None:
    """The name and the unit in a name that states one."""
    found = (form.fullmatch(column) for form in (BRACKETS, SUFFIX))
    return next((match for match in found if match and known_unit(match["unit"])), None)


def units_in_names(names: Sequence[str], renamed: dict[str, str]) -> dict[str, tuple[str, str]]:
    """The columns with a unit in their name: from the old name to ours, and the unit.

    Our name is the one to which a column is `renamed`, else the one before the unit, if we know it.
    """
    new_names = {old: new for new, old in renamed.items()}
    found: dict[str, tuple[str, str]] = {}
    for column in names:
        name, unit = unit_in_name(column) or ("", "")
        if column in new_names and unit:
            found[column] = (new_names[column], unit)
        elif unit and column_type(name) is not None and name not in {*names, *renamed}:
            found[column] = (name, unit)
    return found


def expanded(pairs: dict[str, str], names: Sequence[str], where: str) -> dict[str, str]:
    """The renamings with `q*=positions` replaced by one for each of positions1, positions2, ..."""
    columns: dict[str, str] = {}
    for new, old in pairs.items():
        if "*" not in new:
            columns[new] = old
            continue
        first, _, last = old.partition("*")
        text = re.escape(first) + r"[\[_.]?(\d+)\]?" + re.escape(last)
        found = {int(m[1]): name for name in names if (m := re.fullmatch(text, name))}
        if old in names:
            found = {1: old}
        if not found:
            raise UsageFault(
                f"{where}: --map {new}={old}: no column {old}1; it has {', '.join(names)}"
            )
        for i, number in enumerate(sorted(found), start=1):
            columns[new.replace("*", str(i))] = found[number]
    return columns
