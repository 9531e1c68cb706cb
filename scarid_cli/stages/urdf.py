"""Physically consistent link inertias from identified base parameters, and a URDF with them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.regression.treatment import Treatment
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.drives import drives
from scarid_cli.algorithms.robots.physical import (
    Physical,
    chi_square,
    inertia_of,
    is_possible,
    nearest,
)
from scarid_cli.algorithms.robots.rigid import Held
from scarid_cli.arrays import Array
from scarid_cli.io.table import Table, number, table_of
from scarid_cli.io.urdf import Inertial, rewritten
from scarid_cli.stages.results.estimates import Estimates
from scarid_cli.stages.results.prediction import qualities

SHOWN = 5  # parameters that a message names at most
COLLAPSE = 2.0  # ratio of residual variances above which a warning is given: physical consistency
# then adds more torque error than there was before
LEAST = 1e-9  # share of its mass that a link behind a joint keeps at least
FALL = 0.01  # of R2: a smaller decrease is negligible, however small the residual was


def physical(identified: Estimates) -> Physical:
    """The physically consistent parameters nearest to the identified ones."""
    return nearest(identified.robot, identified.full, identified.covariance, identified.dropped)


def document(
    text: str, robot: Robot, found: Physical, command: str, table: Sequence[str] = ()
) -> str:
    """The URDF with the new inertias, friction and motors; the lines of a table as a comment.

    Links fixed to a moving link are part of its body and lose their own inertia. Those behind
    joints that are no axes keep theirs, because simulators refuse moving links without a mass.
    """
    assert robot.body
    links: dict[str, Inertial | None] = {}
    for axis, (body, (own, fixed)) in enumerate(
        zip(found.bodies, robot.body.links, strict=True), start=1
    ):
        held, share = _held(robot, found, axis)
        links[own] = _inertial(body - share * sum(x.carried for x in held))
        links |= dict.fromkeys(fixed)
        links |= {x.link: _inertial(share * x.own) for x in held}
    own_drives = drives(robot, found.axes)
    moved = own_drives.axes
    friction = {x.joint: (x.viscous, x.coulomb) for x in moved if x.viscous or x.coulomb}
    motors = {x.joint: (x.inertia, x.gear) for x in moved if x.inertia}
    rest = ", ".join(f"{name} {x:.6g}" for name, x in own_drives.not_in_urdf(found.axes).items())
    remark = f"{command}; not part of the URDF: {rest}" if rest else command
    return rewritten(text, links, friction, remark, motors, table)


def _inertial(body: Array) -> Inertial:
    return Inertial.of(body[9], body[6:9], inertia_of(body))


def _held(robot: Robot, found: Physical, axis: int) -> tuple[list[Held], float]:
    """The links that an axis (from 1) carries behind other joints, and the share of their masses.

    It is 1, or halved until the rest of the body of the axis is one that there can be.
    """
    assert robot.body
    held, share = [x for x in robot.body.held if x.axis == axis], 1.0
    body, carried = found.bodies[axis - 1], sum(x.carried for x in held)
    while held and share > LEAST and not is_possible(body - share * carried):
        share *= 0.5
    return held, share


def held_report(robot: Robot, found: Physical) -> Iterator[str]:
    """Which links keep masses of their own that are part of the body of an axis."""
    assert robot.body
    for axis, (own, _) in enumerate(robot.body.links, start=1):
        held, share = _held(robot, found, axis)
        if held:
            names, part = ", ".join(x.link for x in held), "" if share == 1.0 else f"{share:g} of "
            yield (
                f"{names}: behind joints that are no axes, with {part}the masses of the "
                f"description, which {own} is lighter by"
            )


def base_table(table: Table, identified: Estimates, found: Physical) -> Table:
    """The base parameters of the new bodies, as a parameter table that `validate` reads."""
    schema = pa.schema([pa.field("parameter", pa.string()), pa.field("unit", pa.string()),
                        number("estimate"), number("moved")])  # fmt: skip
    robot = identified.robot
    moved = zip(robot.parameters, found.base, _moved(identified, found), strict=True)
    rows = [(p.name, p.unit, value, by) for p, value, by in moved]
    rows += [(*row, 0.0) for row in identified.fixed]
    meta = replace(table.meta, kind="parameters", robot=robot.name, extra={})
    return table_of("urdf", schema, rows, meta)


def r2_before_and_after(
    table: Table, identified: Estimates, found: Physical, treatment: Treatment
) -> tuple[Array, Array]:
    """R2 (eq. 36) per joint of a motion, with the identified and the consistent parameters.

    Rows are treated as in `validate`.
    """
    models = [identified.model, replace(identified.model, theta=found.base)]
    found_r2 = ([joint.r2 for joint in own] for own in qualities(table, models, treatment))
    before, after = map(np.array, found_r2)
    return before, after


def r2_report(before: Array, after: Array) -> Iterator[str]:
    """R2 per joint before and after, and a warning for joints whose R2 falls substantially."""
    yield f"R2 of the identified parameters: {_listed(before)}"
    yield f"R2 of the physically consistent ones: {_listed(after)}"
    lost = (1.0 - after > COLLAPSE * (1.0 - before)) & (before - after > FALL)
    if lost.any():
        falls = ", ".join(
            f"joint {j + 1} from {before[j]:.3f} to {after[j]:.3f}" for j in np.flatnonzero(lost)
        )
        yield (
            f"warning: R2 falls substantially on this motion: {falls}; do not use this URDF for "
            "such motions. Identify the parameters from a log that excites every joint"
        )


def consistency_report(identified: Estimates, found: Physical) -> Iterator[str]:
    """How far the parameters moved, which of them could not stay at zero, and the masses."""
    if identified.remark:
        yield identified.remark
    else:
        yield _distance(identified, found)
    yield _farthest(identified, found)
    yield from _not_zero(identified, found)
    masses = ", ".join(f"{body[9]:.4g}" for body in found.bodies)
    yield f"masses {masses} kg; only combinations of them are identified"


def _distance(identified: Estimates, found: Physical) -> str:
    text = f"Mahalanobis distance from the estimates {found.distance:.2g} standard deviations"
    if identified.dropped:
        return f"{text}, counted from those of all parameters, before any were dropped"
    count = int(np.count_nonzero(np.isfinite(np.diag(identified.covariance))))
    explained = np.sqrt(chi_square(count))
    text = f"{text}; the uncertainty of {count} estimates explains up to {explained:.2g}"
    if found.distance <= explained:
        return text
    return f"{text}: the model or the log has another error, such as friction or delay"


def _not_zero(identified: Estimates, found: Physical) -> Iterator[str]:
    """Dropped parameters that cannot be zero with positive masses."""
    parameters = identified.robot.parameters
    other = [i for i in identified.dropped if found.base[i] != 0.0]
    if other:
        names = [f"{parameters[i].name} ({found.base[i]:.2g} {parameters[i].unit})" for i in other]
        yield (
            f"{len(other)} of {len(identified.dropped)} dropped parameters cannot be zero with "
            f"positive masses: {_first_few(names)}"
        )


def _farthest(identified: Estimates, found: Physical) -> str:
    moved = np.nan_to_num(np.abs(_moved(identified, found)))
    far = [i for i in np.argsort(-moved) if moved[i] > 1.0]
    if not far:
        return f"no parameter moved by more than {moved.max():.2g} standard errors"
    names = _first_few([f"{identified.robot.names[i]} by {moved[i]:.2g}" for i in far])
    return f"{len(far)} of {len(moved)} parameters moved by more than one standard error: {names}"


def _moved(identified: Estimates, found: Physical) -> Array:
    """By how many standard errors the parameters moved (parameters); nan without an error."""
    with np.errstate(invalid="ignore", divide="ignore"):
        moved: Array = (found.base - identified.values) / identified.errors
    return moved


def _first_few(items: Sequence[str]) -> str:
    return ", ".join(items[:SHOWN]) + (", ..." if len(items) > SHOWN else "")


def _listed(values: Array) -> str:
    return ", ".join(f"{value:.3f}" for value in values)
