"""All that a log may have beyond the model, by name, in the order in which columns are made."""

from __future__ import annotations

from types import ModuleType

from scarid_cli.algorithms.beyond import gears, mounting, positions, rows, torques
from scarid_cli.algorithms.beyond.gears import Mismatch
from scarid_cli.algorithms.beyond.phenomenon import OfTorques, Part, Phenomenon, Shape
from scarid_cli.algorithms.beyond.positions import OfPositions

Entry = type[Phenomenon]
# Where it acts, as headings of the documentation.
PLACES: dict[str, ModuleType] = {
    "Torque of a joint": torques,
    "Mounting and geometry": mounting,
    "Gears, and signals that are late": gears,
    "Positions": positions,
    "Rows and low-passes": rows,
}


def declared_in(place: str) -> list[Entry]:
    """The entries of a place, with the parts of others, in the order of its module."""
    module = PLACES[place].__name__
    own = (x for x in vars(PLACES[place]).values() if getattr(x, "__module__", "") == module)
    kinds = (x for x in own if isinstance(x, type) and issubclass(x, Phenomenon))
    return [kind for kind in kinds if "NAME" in vars(kind)]


# With the parts of others, of which additions have the names.
SINGLE: dict[str, Entry] = {kind.NAME: kind for place in PLACES for kind in declared_in(place)}
PHENOMENA = {name: kind for name, kind in SINGLE.items() if not issubclass(kind, Part)}
SHAPES = {name: kind for name, kind in SINGLE.items() if issubclass(kind, Shape)}
TORQUES = {name: kind for name, kind in PHENOMENA.items() if issubclass(kind, OfTorques)}
MISMATCHES = {name: kind for name, kind in PHENOMENA.items() if issubclass(kind, Mismatch)}
POSITIONS = {name: kind for name, kind in PHENOMENA.items() if issubclass(kind, OfPositions)}
# What one gear or sensor has, others may have.
WIDESPREAD = {name: kind for name, kind in MISMATCHES.items() if name in kind.WIDER}


def kind_of(name: str) -> str:
    """The entry as which one of this name is told where it was fitted."""
    return SINGLE[name].kind()
