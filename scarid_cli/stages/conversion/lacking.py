"""What a log lacks once its columns are renamed, and which of its own columns may hold it."""

from __future__ import annotations

import re
import shlex
from collections.abc import Collection, Sequence

from scarid_cli.io.schemas import COUNTED_FROM_0, numbered
from scarid_cli.stages.conversion.recorders import CURRENT, unstated_unit
from scarid_cli.stages.conversion.units import unit_option
from scarid_cli.stages.conversion.wording import (
    AMPERES,
    CLOCK,
    COMMANDED,
    MEASURED,
    POSITION,
    QUANTITIES,
    TORQUE,
    words_of,
)

SHOWN = 8  # names of columns in a message
TICKS = {  # words of a clock whose unit they do not say
    "duration", "elapsed", "micros", "millis", "tick", "ticks", "utime",
}  # fmt: skip
RATE = ": give --rate HZ, if the rate is constant"
NUMBER = re.compile(r"\d+")
FORCES = {"force", "forces", "kraft"}
CONTROLS = {"ctrl"}  # of MuJoCo, the torques of motors
NOT_OWN = COMMANDED | {"ext", "external", "ee", "tcp", "residual", "error", "err"}
LETTER = re.compile(r"[A-Za-z]{1,2}[^A-Za-z]*")


def lacking(kept: Sequence[str], new: Collection[str], *, clock: bool) -> str | None:
    """What to say of a log with these names, some `kept`, some `new`; None if it has all.

    Currents stand for torques. `clock` says that it gets a clock.
    """
    names = [*kept, *new]
    q, tau = numbered(names, "q"), numbered(names, "tau", "current")
    if not names or COUNTED_FROM_0 in names or _of_no_log(names):
        return None
    t = "t" in names or clock
    if not q and not tau:
        shown = ", ".join(kept[:SHOWN]) + (", ..." if len(kept) > SHOWN else "")
        options = _mappings(kept, t=not t, q=True, tau=True) or _mapping("q1", kept[0])
        return (
            f"no column is recognised as positions or torques; it has {shown}: name them, as in "
            f"{options}"
        )
    rest = [name for name in kept if name not in (*q, *tau)]
    hints = [
        ("no positions", q, _perhaps(kept, q=True) or _perhaps_alike("q", rest, len(tau))),
        ("no torques", tau, _perhaps(kept, tau=True) or _perhaps_alike("tau", rest, len(q))),
        ("no clock", t, _perhaps(kept, t=True) or RATE),
    ]
    # A table with names of ours alone may be one of positions on purpose.
    parts = [what + hint for what, there, hint in hints if not there and (hint or new)]
    return "; ".join(parts) or None


def _of_no_log(names: Collection[str]) -> bool:
    """Whether these are the columns of one of our tables that is no log."""
    return bool({"parameter", "joint", "method", "dq1", "ddq1", "q1_ref"} & {*names})


def _perhaps(left: Sequence[str], **wanted: bool) -> str:
    found = _mappings(left, **wanted)
    return f": perhaps {found}" if found else ""


def _mappings(left: Sequence[str], *, t: bool = False, q: bool = False, tau: bool = False) -> str:
    """The options that name these columns, as far as words in their names say so."""
    clocks = [name for name in left if {*words_of(name)} & (CLOCK | TICKS)]
    pairs = [("t", clocks[0])] if t and clocks else []
    positions = _pair("q", left, QUANTITIES[POSITION]) if q else []
    torques = _torques(left) if tau else []
    if q and tau:  # what one of them says tells how many columns the other one has
        positions = positions or _alike("q", left, torques)
        torques = torques or _alike("tau", left, positions)
    return " ".join(_mapping(new, name) for new, name in [*pairs, *positions, *torques])


def _torques(left: Sequence[str]) -> list[tuple[str, str]]:
    """Which columns become torques, or currents."""
    currents = _pair("current", left, QUANTITIES[CURRENT] | AMPERES)
    torques = _pair("tau", left, QUANTITIES[TORQUE] - FORCES)  # beside which a force is another
    return torques or _pair("tau", left, FORCES) or currents or _pair("tau", left, CONTROLS)


def _perhaps_alike(new: str, left: Sequence[str], count: int) -> str:
    """The option that names as many columns that are numbered, if there is one such pattern.

    Of letters alone, as u1 or A1: a longer name says that they are something else.
    """
    short = [name for name in left if LETTER.fullmatch(name)]
    if new == "tau":  # beside its derivative, as tq beside tqd: a target position, and no torque
        short = [name for name in short if not _derived(name) & {*left}]
    found = _numbered(short, count)
    return f": perhaps {_mapping(f'{new}*', found)}" if found else ""


def _derived(name: str) -> set[str]:
    """How the derivative of a column is called: `tqd_0` of `tq_0`, or `dq1` of `q1`."""
    letters = re.match("[A-Za-z]+", name)
    stem = letters[0] if letters else ""
    return {f"{stem}d{name[len(stem) :]}", f"d{name}"}


def _alike(new: str, left: Sequence[str], found: list[tuple[str, str]]) -> list[tuple[str, str]]:
    """The columns that become `new` ones, as many as those that were `found`."""
    if not found or "*" not in found[0][1]:
        return []
    own = _patterns(left)[found[0][1]]
    pattern = _numbered([name for name in left if name not in own], len(own))
    return [(f"{new}*", pattern)] if pattern else []


def _numbered(left: Sequence[str], count: int) -> str:
    """The one pattern of so many of these names that differ in a number, or nothing."""
    free = [name for name in left if not {*words_of(name)} & COMMANDED]
    patterns = [pattern for pattern, own in _patterns(free).items() if len(own) == count > 1]
    return patterns[0] if len(patterns) == 1 else ""


def _patterns(names: Sequence[str]) -> dict[str, list[str]]:
    """Names by what they have in common beside a number: `axis*.pos`."""
    groups: dict[str, list[str]] = {}
    for name in names:
        for match in NUMBER.finditer(name):
            pattern = f"{name[: match.start()]}*{name[match.end() :]}"
            groups.setdefault(pattern, []).append(name)
    return groups


def _pair(new: str, left: Sequence[str], words: Collection[str]) -> list[tuple[str, str]]:
    """Which columns become `new` ones: as many as one pattern names, or one."""
    name = _most(left, words)
    return [(f"{new}*" if "*" in name else f"{new}1", name)] if name else []


def _mapping(new: str, name: str) -> str:
    unit = f" {unit_option(new, 'X')}" if unstated_unit(name) else ""
    return f"--map {shlex.quote(f'{new}={name}')}{unit}"


def _most(names: Sequence[str], words: Collection[str]) -> str:
    """The pattern of most names that have one of these words, as `axis*.pos`; or such a name.

    Of what is said to be measured, if anything is; nothing that is external is a joint's own.
    """
    own = [x for x in names if {*words_of(x)} & {*words} and not {*words_of(x)} & NOT_OWN]
    own = [x for x in own if {*words_of(x)} & MEASURED] or own
    groups = {**_patterns(own), **{name: [name] for name in own}}
    best = max(groups, key=lambda pattern: len(groups[pattern]), default="")
    return best if len(groups.get(best, ())) > 1 else groups[best][0] if best else ""
