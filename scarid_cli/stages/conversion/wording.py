"""What the columns of a log hold, from the words in their names: `arm_2_joint_position`."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass

from scarid_cli.errors import UsageFault
from scarid_cli.io.schemas import COUNTED_FROM_0, column_type, named, numbered
from scarid_cli.stages.conversion.recorders import (
    CURRENT,
    Recognised,
    recognised,
    unit_in_name,
    unstated_unit,
)
from scarid_cli.stages.conversion.units import UNITS, unit_option

POSITION, VELOCITY, TORQUE = "q{i}", "dq{i}_measured", "tau{i}"
# In English, German, French, Spanish and Italian, without accents.
QUANTITIES = {
    POSITION: {
        "achsposition", "achswinkel", "angle", "angles", "angolo", "angulo", "gelenkposition",
        "gelenkwinkel", "istposition", "pos", "posicion", "position", "positionen", "positions",
        "posizione", "q", "qpos", "theta", "winkel",
    },
    VELOCITY: {
        "achsgeschwindigkeit", "dq", "drehzahl", "geschwindigkeit", "istgeschwindigkeit", "qd",
        "qdot", "qvel", "speed", "speeds", "vel", "velocidad", "velocita", "velocities", "velocity",
        "vitesse",
    },
    TORQUE: {
        "achsmoment", "coppia", "couple", "drehmoment", "effort", "efforts", "force", "forces",
        "istmoment", "kraft", "moment", "momente", "momento", "qfrc", "tau", "torque", "torques",
        "trq",
    },
    CURRENT: {"corrente", "corriente", "courant", "current", "currents", "strom"},
}  # fmt: skip
AMPERES = {"amp", "ampere", "amperes", "amps", "cur", "curr", "iq"}  # words of currents only
CLOCK = {
    "date", "datetime", "sec", "seconds", "secs", "stamp", "t", "temps", "tempo", "tiempo", "time",
    "times", "timestamp", "timestamps", "tout", "ts", "zeit", "zeitstempel",
}  # fmt: skip
# A word of the clock.
BESIDE = {"elapsed", "field", "header", "log", "relative", "ros", "sim", "wall"}
FRACTION = {"nanosec", "nanosecs", "nsec", "nsecs", "usec", "usecs"}  # that a clock leaves out
# Words that tell neither the joint nor the quantity.
PLAIN = {
    "achse", "act", "actual", "actuator", "applied", "articulation", "asse", "axe", "axis",
    "current", "data", "eje", "feedback", "field", "gelenk", "giunto", "ist", "j", "jnt", "joint",
    "joints", "js", "link", "log", "meas", "measured", "msr", "present", "signals", "state",
    "states", "value", "values",
}  # fmt: skip
MEASURED = {"act", "actual", "feedback", "ist", "meas", "measured", "msr"}
# Words of what was commanded or wished.
COMMANDED = {
    "cmd", "command", "commanded", "commands", "d", "des", "desired", "goal", "planned", "ref",
    "reference", "set", "setpoint", "soll", "target", "targets",
}  # fmt: skip
# Words of what was not measured at a joint itself: references, estimates, motors, the tool.
OTHER = COMMANDED | {
    "bias", "cartesian", "constraint", "coriolis", "ddot", "dot", "ee", "eef", "encoder", "err",
    "error", "est", "estimate", "estimated", "ext", "external", "feedforward", "ff", "filt",
    "filtered", "friction", "gravity", "hat", "limit", "lp", "max", "mean", "min", "model", "motor",
    "motors", "nominal", "passive", "pose", "predicted", "raw", "residual", "rms", "smooth",
    "smoothed", "std", "tcp", "temperature", "tool", "var", "x", "y", "z",
}  # fmt: skip
# Words of a clock, whatever else the name of its column says.
TIMES = {"stamp", "time", "times", "timestamp", "timestamps", "tout"}
# What a unit alone says of a column whose words say nothing but the joint.
BY_UNIT = {"deg": POSITION, "rad": POSITION, "rev": POSITION, "deg/s": VELOCITY,
           "rad/s": VELOCITY, "rpm": VELOCITY, "N m": TORQUE, "mN m": TORQUE, "kN m": TORQUE,
           "N mm": TORQUE, "N cm": TORQUE, "kgf m": TORQUE, "kgf cm": TORQUE, "lbf ft": TORQUE,
           "lbf in": TORQUE, "ozf in": TORQUE, "A": CURRENT, "mA": CURRENT}  # fmt: skip
# Signs of formulas, and a dot or two above a q or theta, by their words.
SIGNS = {"\u03b8": " theta ", "\u03d1": " theta ", "\u03c4": " tau ", "q\u0307": " qdot ",
         " theta \u0307": " qdot ", "q\u0308": " ddot ", " theta \u0308": " ddot "}  # fmt: skip
WORD = re.compile(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])|\d+")
INSIDE = re.compile(r"[^./]+[./]")  # the name of a structure, before that of its member

Key = tuple[str, ...]  # the words that tell the joint: ("3",), ("shoulder", "pan")


class Unclear(Exception):
    """Why the columns of a log are not renamed."""


@dataclass(frozen=True)
class _Column:
    name: str
    unit: str
    words: tuple[str, ...]
    unstated: str = ""  # a unit that only the device knows


def in_words(
    names: Sequence[str], given: Collection[str], joints: Sequence[str]
) -> Recognised | None:
    """The columns whose names say in words what they hold, and of which joint.

    `given` are names of ours that need no column. `joints` gives the order of joints with names, by
    default that of their columns; joints with numbers are in the order of these, from 0 or 1. What
    somebody computed or commanded is left alone. None if there is nothing to rename; Unclear if
    two columns could have one name, or if the joints cannot be put in order.
    """
    ours = {"t"} if COUNTED_FROM_0 in names else {name for name in names if column_type(name)}
    known = {*given, *ours.intersection(names)}
    columns = [_read(name) for name in names if name not in known]
    found = {new: _by_joint(new, columns) for new in _wanted(known)}
    if "q1" not in known and not found[POSITION]:
        return None  # no log of a robot
    if found.get(TORQUE) or "tau1" in known:
        found.pop(CURRENT, None)
    measured = [found[new] for new in (POSITION, TORQUE, CURRENT) if found.get(new)]
    order = _order(measured, joints)
    if "q1" in known and not _numbers(order):
        order = []  # nothing says which joint is the first one
    pairs = [] if "t" in known else _clock(columns, _structure(names))
    for new, own in found.items():
        if all(key in own for key in order):
            pairs += [(new.replace("{i}", str(i + 1)), own[key]) for i, key in enumerate(order)]
    units = tuple((new, column.unit) for new, column in pairs if column.unit)
    by_name = () if _numbers(order) else tuple(" ".join(key) for key in order)
    renamed = {new: column.name for new, column in pairs}
    positions = found.get(POSITION, {})
    left_out = tuple(own.name for key, own in positions.items() if key not in order)
    return Recognised("", renamed, units, by_name, left_out) if renamed else None


def renamable(columns: Sequence[str]) -> bool:
    """Whether a log has no columns t and q1 of ours, and `scarid convert` gives it some."""
    if named(columns):
        return False
    try:
        found = recognised(columns, None, (), "") or in_words(columns, (), ())
    except UsageFault:  # `convert` says what it needs
        return True
    except Unclear:
        return False
    return found is not None and {"t", "q1"} <= {*columns, *found.columns}


def is_current(name: str) -> bool:
    """Whether the words of a name say a current, and no other quantity."""
    words = {*words_of(name)}
    known = QUANTITIES[POSITION] | QUANTITIES[VELOCITY] | QUANTITIES[TORQUE]
    return bool(words & {*AMPERES, *QUANTITIES[CURRENT]}) and words.isdisjoint(known)


def current_as_torque(new: str, old: str) -> bool:
    """Whether a column becomes a torque that is a current by its name."""
    return bool(numbered([new], "tau")) and is_current(old)


def in_short(found: Recognised) -> str:
    """Which columns become which: `t from time; q1 to q6 from angle_0 (deg) to angle_5 (deg)`."""
    units = dict(found.units)
    groups: dict[str, dict[str, str]] = {}
    for new, old in found.columns.items():
        text = f"{old} ({units[new]})" if units.get(new) in UNITS else old
        groups.setdefault(re.sub(r"\d+", "", new), {})[new] = text
    return "; ".join(f"{_few([*own])} from {_few([*own.values()])}" for own in groups.values())


def _few(names: list[str]) -> str:
    """All names, or the first and the last of more than two that differ in numbers only."""
    alike = len({re.sub(r"\d+", "", name) for name in names}) == 1
    return f"{names[0]} to {names[-1]}" if alike and len(names) > 2 else ", ".join(names)


def _structure(names: Sequence[str]) -> str:
    """How all names begin if they are members of one structure, as `out.`; else nothing."""
    found = {m[0] if (m := INSIDE.match(name)) else "" for name in names}
    return found.pop() if len(found) == 1 and len(names) > 1 else ""


def words_of(name: str) -> tuple[str, ...]:
    """The words of a name in small letters without accents, and its numbers without zeros."""
    plain = name
    if not name.isascii():
        from unicodedata import combining, normalize  # not needed otherwise

        plain = normalize("NFKD", name)
        for sign, word in SIGNS.items():
            plain = plain.replace(sign, word)
        plain = "".join(c for c in plain if not combining(c))
    words = (word.lower() for word in WORD.findall(plain))
    return tuple(str(int(word)) if word.isdigit() else word for word in words)


def _read(name: str) -> _Column:
    """A column, the unit that its name states, and the words before it."""
    if unit := unstated_unit(name):
        return _Column(name, "", words_of(name[: name.rindex(unit)]), unit)
    before, unit = unit_in_name(name) or (name, "")
    return _Column(name, unit, words_of(before))


def _wanted(known: Collection[str]) -> list[str]:
    """The quantities of which a log has no column with our name."""
    wanted = [new for new in QUANTITIES if new.replace("{i}", "1") not in known]
    if "q1" in known and VELOCITY in wanted:
        wanted.remove(VELOCITY)  # which keep their names beside positions that have ours
    return wanted


def _clock(columns: Sequence[_Column], structure: str) -> list[tuple[str, _Column]]:
    """The column of the time, preferably the stamp in the header of a message.

    It may be a member of the structure that all columns are in.
    """
    if any({*column.words} & FRACTION for column in columns):
        return []  # seconds in one column, their fractions in another
    beside = BESIDE.union(words_of(structure))
    named = [c for c in columns if {*c.words} & CLOCK and {*c.words} <= CLOCK | beside]
    found = [column for column in named if not column.unstated]
    stamps = [column for column in found if "header" in column.words]
    return [("t", column) for column in (stamps or found)[:1]]


def _by_joint(new: str, columns: Sequence[_Column]) -> dict[Key, _Column]:
    """The columns of a quantity, by the words that tell their joint."""
    found: dict[Key, _Column] = {}
    for column in columns:
        if _quantity(column) != new:
            continue
        if column.unstated:
            raise Unclear(
                f"{column.name} does not say what one {column.unstated} is (state it as well, as "
                f"in {unit_option(new.replace('{i}', '*'))})"
            )
        key = tuple(word for word in column.words if word not in PLAIN | QUANTITIES[new])
        if key in found and _measured(found[key]) != _measured(column):
            column = column if _measured(column) else found[key]
        elif key in found:
            what = new.replace("{i}", "")
            raise Unclear(f"both {found[key].name} and {column.name} could be {what} of one joint")
        found[key] = column
    return found


def _measured(column: _Column) -> bool:
    """Whether the name says so, as beside a command that does not say that it is one."""
    return bool({*column.words} & MEASURED)


def _quantity(column: _Column) -> str | None:
    """What a column holds, if its name says this, and nothing against it."""
    words = {*column.words}
    if words & TIMES:
        return None
    kinds = {new for new, own in QUANTITIES.items() if own & words}
    if not kinds and all(word in PLAIN or word.isdigit() for word in words):
        return BY_UNIT.get(column.unit)
    if len(kinds) > 1:
        kinds.discard(CURRENT)  # "current" means "present" beside another quantity
    return kinds.pop() if len(kinds) == 1 and not OTHER & words else None


def _order(found: Sequence[dict[Key, _Column]], joints: Sequence[str]) -> list[Key]:
    """The joints that all these quantities have, in order."""
    common = [key for key in found[0] if all(key in own for own in found)] if found else []
    if found and not common:
        first, second = (next(iter(own.values())).name for own in found)
        raise Unclear(f"{first} and {second} seem to be of different joints")
    wanted = [tuple(word for word in _read(joint).words if word not in PLAIN) for joint in joints]
    if moved := _counted_otherwise(common, wanted):
        return moved
    for own in found:
        lacking = [joint for joint, key in zip(joints, wanted, strict=True) if key not in own]
        if len(lacking) < len(joints) and lacking:
            names = ", ".join(column.name for column in own.values())
            raise Unclear(f"there is {names}, but none of {', '.join(lacking)}")
    if wanted and all(key in common for key in wanted):
        return wanted
    numbers = _numbers(common)
    order = sorted(numbers)
    if numbers and (order[0] > 1 or not _in_turn(numbers)):
        raise Unclear(f"their joints are numbered {', '.join(map(str, order))}")
    if common and wanted and not numbers:
        raise Unclear(f"they have none of the joints {', '.join(joints)}")
    return [numbers[number] for number in order] or common


def _counted_otherwise(common: Sequence[Key], wanted: Sequence[Key]) -> list[Key]:
    """All joints in order, where columns count them from 0 and the robot from 1, or reversely.

    Unclear if columns from 0 are more than the joints from 1: the first may be another axis.
    """
    columns, own = _numbers(common), _numbers(wanted)
    if not (_in_turn(columns) and _in_turn(own) and [*own] == sorted(own)):
        return []
    if {min(columns), min(own)} != {0, 1}:
        return []
    if len(columns) > len(own) and 0 in columns:
        first_ones = ",".join(str(number) for number in range(len(own)))
        raise Unclear(
            f"{len(columns)} joints are numbered from 0, and those of the robot from 1 to "
            f"{max(own)} (--joints {first_ones} takes the first ones)"
        )
    return [columns[number] for number in sorted(columns)] if len(columns) == len(own) else []


def _in_turn(numbers: Collection[int]) -> bool:
    """Whether there are numbers, and none between the first and the last is left out."""
    return bool(numbers) and sorted(numbers) == [*range(min(numbers), min(numbers) + len(numbers))]


def _numbers(keys: Sequence[Key]) -> dict[int, Key]:
    """The joints by their numbers, if the words of their names differ in nothing else."""
    if list(keys) == [()]:
        return {1: ()}
    found = {int(word): key for key in keys for word in key if word.isdigit()}
    others = {tuple("" if word.isdigit() else word for word in key) for key in keys}
    return found if len(found) == len(keys) and len(others) == 1 else {}
