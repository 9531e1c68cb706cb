"""The table of a payload, from the parameters of the bare robot and of the loaded one."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import isfinite

import numpy as np

from scarid_cli.algorithms.changes import payload as algorithm
from scarid_cli.algorithms.changes.payload import NAMES, UNITS, Payload
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.rigid import Frame
from scarid_cli.arrays import Array
from scarid_cli.errors import BadData, UsageFault
from scarid_cli.interval import HALF, plus_minus
from scarid_cli.io import schemas
from scarid_cli.io.table import Table, table_of
from scarid_cli.stages.models.controllers import settings
from scarid_cli.stages.results.estimates import Estimates

LOADED = "loaded"  # in the metadata: the verdict on the loaded robot
OF_TORQUES = (
    "the intervals assume that the logged torques are right: if they are 1 % too large, so is the "
    "mass (a load of known mass shows this: `scarid gains`)"
)


def payload(bare: Estimates, loaded: Estimates, link: str | None) -> tuple[Payload, str]:
    """The payload in the frame of a link, by default the tool's; the name of the link."""
    robot = bare.robot
    frame, name = frame_of(robot, link, "a payload needs")
    covariance = bare.covariance + loaded.covariance
    found = algorithm.standard(algorithm.directions(robot), loaded.full - bare.full, covariance)
    if not np.any(found.phi):
        raise BadData("payload: both identifications are the same; give a log with the payload")
    if not np.isfinite(found.covariance[algorithm.MASS, algorithm.MASS]):
        raise BadData(_without_mass(found))
    return algorithm.in_frame(found, frame), name


def _without_mass(found: algorithm.Standard) -> str:
    """What is known of a payload whose mass is not: as of a wrist whose axes meet in one point."""
    parts = [
        f"{name} {found.phi[k]:.4g} {plus_minus(error)} kg m"
        for name, k in zip(NAMES[1:4], algorithm.MOMENTS, strict=True)
        if np.isfinite(error := float(np.sqrt(found.covariance[k, k])))
    ]
    known = f"; mass times centre, in the frame of the last axis: {', '.join(parts)}"
    return (
        "payload: the motion does not tell its mass; use a motion that turns the last links "
        "against gravity (no motion tells it where all axes meet in one point)"
        f"{known if parts else ''}"
    )


def frame_of(robot: Robot, link: str | None, who: str) -> tuple[Frame, str]:
    """The frame of a link that is fixed to the last axis, by default the tool; its name.

    `who` needs it, as in `a payload needs`.
    """
    if not robot.body:
        raise UsageFault(f"{robot.name}: {who} a robot with a URDF")
    name, frames = link or robot.body.tool, robot.body.frames
    last = len(robot.body.link_numbers)
    if name not in frames or frames[name].axis != last:
        own = ", ".join(k for k, frame in frames.items() if frame.axis == last)
        raise UsageFault(f"--frame {name}: no link that is fixed to the last axis; it has {own}")
    return frames[name], name


def table(found: Payload, of: Table, link: str) -> Table:
    """A row for each of the ten values, with its 95 % interval."""
    half, values = HALF * found.errors, np.where(np.isnan(found.errors), np.nan, found.values)
    rows = zip(
        NAMES, UNITS, values, found.errors, values - half, values + half, found.told, strict=True
    )
    extra = {
        "frame": link,
        "possible": found.possible,
        "away": found.away,
        LOADED: loaded(of),
    }
    meta = replace(of.meta, kind="payload", extra=extra)
    return table_of("payload", schemas.load("payload").arrow(), list(rows), meta)


def loaded(table: Table) -> dict[str, object] | None:
    """The verdict on the loaded robot and its reasons, from its parameters; None without one."""
    extra = table.meta.extra
    if "verdict" not in extra:
        return None
    return {"verdict": extra["verdict"], "reasons": list(extra["reasons"])}


def told(found: Payload, link: str) -> Iterator[str]:
    """What hangs there, what the motion does not tell, and whether a body can be like this."""
    mass, half = float(found.values[0]), plus_minus(found.errors[0])
    if not found.shown:
        yield f"nothing more than the bare robot has hangs on {link}: mass {mass:.3g} {half} kg"
        return
    if mass < 0.0:
        yield (
            f"{-mass:.4g} {half} kg less than the bare robot has hangs on {link}: give the log "
            "with the lighter tool for --parameters"
        )
        return
    parts = [
        f"{name} {value:.4g} {plus_minus(error)} {unit}"
        for name, value, error, unit in zip(
            NAMES[:4], found.values[:4], found.errors[:4], UNITS[:4], strict=True
        )
        if np.isfinite(error)
    ]
    yield f"payload in the frame of {link}: {', '.join(parts)}"
    unknown = [name for name, error in zip(NAMES, found.errors, strict=True) if np.isnan(error)]
    if unknown:
        yield f"not told by this motion: {', '.join(unknown)}"
    if found.vague:
        yield f"not distinguishable from 0: {', '.join(found.vague)}"
    if not found.possible:
        yield (
            "warning: no body has these values. The nearest one, "
            f"{found.away:.2g} standard deviations away, has {_text(found.told)}; take a motion "
            "with larger accelerations for the inertia"
        )
    for controller, line in settings(found.told, found.values - HALF * found.errors).items():
        yield f"for {controller}, if {link} is its flange: {line}"


def _text(values: Array) -> str:
    """Mass, centre and moments of inertia in a line, as far as they are told."""
    named = zip(NAMES, values.tolist(), UNITS, strict=True)
    return ", ".join(f"{name} {x:.3g} {unit}" for name, x, unit in named if isfinite(x))
