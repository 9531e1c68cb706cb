"""The section on the gains of the torques, of `scarid gains`."""

from __future__ import annotations

from collections.abc import Sequence

from scarid_cli.reporting.kinds import JointGains
from scarid_cli.reporting.parts import Section, number
from scarid_cli.reporting.wording import shown, titled


def gains(group: Sequence[JointGains]) -> list[Section]:
    """The gain of each joint's torque with its 95 % interval, a section for each table."""
    return [_section(one, name) for one, name in zip(group, shown(group), strict=True)]


def _section(one: JointGains, name: str) -> Section:
    rows = zip(one.joints, one.factors, one.low, one.high, strict=True)
    return Section(
        title=titled("Gains of the torques", name if name != "gains" else ""),
        note="The logged torque of each joint, divided by the true one. An empty gain is one that "
        "the motion does not tell.",
        headers=("joint", "gain", "low", "high", "differs from 1"),
        rows=tuple(
            (str(j), *map(number, values), "yes" if j in one.wrong else "no") for j, *values in rows
        ),
    )
