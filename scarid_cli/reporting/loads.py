"""The sections on what hangs on the flange, of `scarid payload`."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

from scarid_cli.reporting.kinds import Hung, Loads
from scarid_cli.reporting.parts import Section, number
from scarid_cli.reporting.wording import shown, titled


def payloads(group: Sequence[Hung]) -> list[Section]:
    """The ten values of each payload with their 95 % intervals, a section for each table."""
    return [_payload(one, name) for one, name in zip(group, shown(group), strict=True)]


def _payload(one: Hung, name: str) -> Section:
    impossible = " The mass is below 0: less hangs there than on the bare robot."
    if isfinite(one.away):
        impossible = (
            f" No body has these values; the nearest one is {one.away:.2g} standard deviations "
            "away."
        )
    note = (
        f"What hangs on the flange, in the frame of {one.frame}: mass, centre, and inertia about "
        "the centre. An empty value is one that the motion does not tell."
    )
    rows = zip(one.quantities, one.units, one.values, one.low, one.high, one.body, strict=True)
    return Section(
        title=titled("Payload", name if name != "payload" else ""),
        note=note if one.possible else note + impossible,
        headers=("quantity", "unit", "estimate", "low", "high", "nearest body"),
        rows=tuple((quantity, unit, *map(number, values)) for quantity, unit, *values in rows),
    )


def loads(group: Sequence[Loads]) -> list[Section]:
    """What a robot carried over time, a section for each table."""
    return [_loads(one, name) for one, name in zip(group, shown(group), strict=True)]


def _loads(one: Loads, name: str) -> Section:
    return Section(
        title=titled("Payloads over time", name if name != "loads" else ""),
        note="From when to when what hung there [s], when the change was found [s], and its mass "
        "[kg] with half its 95 % interval.",
        headers=("from", "to", "found", "mass", "+-"),
        rows=tuple(tuple(map(number, row)) for row in one.rows),
    )
