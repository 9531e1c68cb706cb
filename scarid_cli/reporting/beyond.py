"""Render the catalogue of what a log may have beyond the model as the page docs/beyond.md."""

from __future__ import annotations

from inspect import getdoc

from scarid_cli.algorithms.beyond.catalogue import PHENOMENA, PLACES, Entry, declared_in
from scarid_cli.algorithms.beyond.phenomenon import Composite

INTRODUCTION = """\
# What a log may have beyond the model

A model of a robot leaves things out, and a log is not always what it says. This page lists what
`scarid identify` looks for in every log, beside the parameters of the robot
([how](verdict.md#what-it-looks-for)). What is found is named by the verdict, with the remedy. It is
fitted with the parameters where it explains all that is left; otherwise their intervals allow for
it.

- *Size in* is the unit of what is fitted, of a joint that turns. In an equation s is the size, dq
  the velocity, tau the torque of a joint, and tau_t what of it the gears transmit.
- *Term* is the term of a robot description that has it, if there is one ([robots.md](robots.md)).
- *simulate --with* is the imperfection that causes it ([simulator.md](simulator.md)).
- *validate* is what `scarid validate` calls it where it differs between two logs
  ([validation.md](validation.md)).

Gains are told with their intervals, as torques that do not fit together
([how](errors.md#the-gain-of-one-joint)).

The page is generated from the catalogue `scarid_cli/algorithms/beyond/` by `make docs`. How often
each of them is named in simulated logs: `python benchmarks/named.py`.
"""
HEAD = (
    "| entry | what it is | size in | term | simulate --with | validate |\n"
    "|---|---|---|---|---|---|"
)
# What stands in the sentences in place of the joints and so on.
SHOWN = {
    "joints": "joint 2",
    "periods": "10 periods per rad",
    "gravity": " (state gravity = [0.17, 0, -9.81] in the TOML file of the robot)",
    "zeros": "joint 2 is at 0.05 rad",
    "distances": "the distance from axis 1 to axis 2 is 1 % larger",
}


def page() -> str:
    """The page, in Markdown."""
    return "\n".join([INTRODUCTION, *map(_section, PLACES)])


def _section(place: str) -> str:
    entries = [entry for entry in declared_in(place) if entry.NAME in PHENOMENA]
    rows = "\n".join(map(_row, entries))
    said = [f"- *{x.NAME}*: {x.LACKS.format_map(SHOWN)}" for x in entries if x.LACKS]
    sentences = "\n".join(["What the verdict says:", "", *said])
    return f"## {place}\n\n{HEAD}\n{rows}\n\n{sentences}\n"


def _row(entry: Entry) -> str:
    what = " ".join((getdoc(entry) or "").split("\n\n")[0].split()).replace("|", "\\|")
    cells = [
        entry.NAME,
        what,
        unit(entry),
        ", ".join(f"`{x}`" for x in entry.TERMS),
        ", ".join(f"`{x}`" for x in entry.IMPERFECTIONS),
        entry.CHANGE,
    ]
    return f"| {' | '.join(cells)} |"


def unit(entry: Entry) -> str:
    """The unit of its size, of a joint that turns; of several shapes those of all."""
    parts = entry.PARTS if issubclass(entry, Composite) else (entry,)
    units = [part.UNIT.format(torque="N m", position="rad") for part in parts]
    return ", ".join(dict.fromkeys(units))


if __name__ == "__main__":
    print(page(), end="")  # noqa: T201
