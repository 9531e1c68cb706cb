"""The table [control] of a robot description: the controller of the simulated robot.

[control]
kind = "pid"             # pd, pid, pd-gravity or computed-torque
kp = [800.0, 25.0]       # gains of each joint; leave all gains out to find them from a bandwidth
kd = [100.0, 2.5]
ki = [0.0, 0.0]
velocity_cutoff = 20.0   # Hz, of the low-pass of the differentiated encoder
bandwidth = 5.0          # Hz, in place of the gains
"""

from __future__ import annotations

from typing import Any

from scarid_cli.algorithms.keys import values
from scarid_cli.algorithms.robots.description import Control

KINDS = ("pd", "pid", "pd-gravity", "computed-torque")
GAINS = ("kp", "kd", "ki")
KEYS = ("kind", *GAINS, "velocity_cutoff", "bandwidth")


def control_of(document: dict[str, Any], joints: int) -> Control | None:
    """The controller that a description gives, if it gives one."""
    entry = document.get("control")
    if not entry:
        return None
    values.only("[control]", entry, KEYS)
    kind = values.choice("kind", entry.get("kind", Control.kind), KINDS)
    if not set(entry) & {*GAINS, "velocity_cutoff"}:
        bandwidth = values.number("bandwidth", entry.get("bandwidth", 0.0))
        return Control(kind=kind, bandwidth=bandwidth)
    if "bandwidth" in entry:
        raise ValueError("[control] has gains and a bandwidth; give one or the other")
    kp, kd, ki = (_row(key, entry[key], joints) for key in GAINS)
    cutoff = values.number("velocity_cutoff", entry["velocity_cutoff"])
    return Control(kp, kd, ki, velocity_cutoff=cutoff, kind=kind)


def _row(key: str, entry: list[Any], joints: int) -> tuple[float, ...]:
    row = tuple(values.number(key, x) for x in entry)
    if len(row) != joints:
        raise ValueError(f"{key} has {len(row)} values for {joints} joints")
    return row
