"""What a log lacks once its columns are renamed, and which of its own columns may hold it."""

from __future__ import annotations

import re
import shlex
from collections.abc import Collection, Sequence

from scarid_cli.io.schemas import COUNTED_FROM_0, numbered
from scarid_cli.stages.recorders import CURRENT
from scarid_cli.stages.wording import (
    AMPERES,
    CLOCK,
    COMMANDED,
    POSITION,
    QUANTITIES,
    TORQUE,
    words_of,
)

SHOWN = 8  # names of columns in a message
TICKS = {"micros", "millis", "tick", "ticks"}  # words of a clock whose unit they do not say
RATE = ": give --rate HZ, if the rate is constant"
NUMBER = re.compile(r"\d+")


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
    hints = [
        ("no positions", q, _perhaps(kept, q=True)),
        ("no torques", tau, _perhaps(kept, tau=True)),
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
    pairs += _pair("q", left, QUANTITIES[POSITION]) if q else []
    if tau:
        currents = _pair("current", left, QUANTITIES[CURRENT] | AMPERES)
        pairs += _pair("tau", left, QUANTITIES[TORQUE]) or currents
    return " ".join(_mapping(new, name) for new, name in pairs)


def _pair(new: str, left: Sequence[str], words: Collection[str]) -> list[tuple[str, str]]:
    """Which columns become `new` ones: as many as one pattern names, or one."""
    name = _most(left, words)
    return [(f"{new}*" if "*" in name else f"{new}1", name)] if name else []


def _mapping(new: str, name: str) -> str:
    return f"--map {shlex.quote(f'{new}={name}')}"


def _most(names: Sequence[str], words: Collection[str]) -> str:
    """The pattern of most names that have one of these words, as `axis*.pos`; or such a name."""
    groups: dict[str, list[str]] = {}
    for name in names:
        own = {*words_of(name)}
        if own & {*words} and not own & COMMANDED:
            for match in NUMBER.finditer(name):
                pattern = f"{name[: match.start()]}*{name[match.end() :]}"
                groups.setdefault(pattern, []).append(name)
            groups.setdefault(name, []).append(name)
    best = max(groups, key=lambda pattern: len(groups[pattern]), default="")
    return best if len(groups.get(best, ())) > 1 else groups[best][0] if best else ""
