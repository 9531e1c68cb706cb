"""Bodies that can exist from identified base parameters, and a URDF that has them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.physical import Physical, inertia_of, nearest
from scarid_cli.arrays import Array
from scarid_cli.io.table import Table, doubles, number
from scarid_cli.io.urdf import Inertial, rewritten
from scarid_cli.stages.parameters import identified, known


def physical(table: Table, robot: Robot) -> Physical:
    """The nearest to a table of parameters, in its robust errors, else in its standard errors."""
    batches = list(table.batches)
    theta = identified(replace(table, batches=iter(batches)), robot).theta
    return nearest(robot, theta, _errors(table.columns, batches, len(theta)))


def _errors(columns: list[str], batches: list[pa.RecordBatch], count: int) -> Array:
    for name in ("robust_error", "standard_error"):
        if name in columns:
            parts = [batch.column(name).to_numpy(zero_copy_only=False) for batch in batches]
            errors = np.concatenate(parts).astype(np.float64)[:count]
            if np.isfinite(errors).any():
                return np.where(errors > 0.0, errors, np.nan)
    return np.full(count, np.nan)


def document(text: str, robot: Robot, found: Physical, command: str) -> str:
    """The URDF with the new bodies; links fixed to one are counted to it and lose their own."""
    assert robot.body
    links: dict[str, Inertial | None] = {}
    for body, (own, fixed) in zip(found.bodies, robot.body.links, strict=True):
        links[own] = Inertial.of(body[9], body[6:9], inertia_of(body))
        links |= dict.fromkeys(fixed)
    friction, written = {}, set()
    for i, name in enumerate(robot.body.joint_names, start=1):
        own_names = (f"fv{i}", f"fs{i}")
        if all(own in found.axes for own in own_names):
            friction[name] = (found.axes[own_names[0]], found.axes[own_names[1]])
            written |= set(own_names)
    rest = ", ".join(f"{k} {x:.6g}" for k, x in found.axes.items() if k not in written)
    return rewritten(text, links, friction, f"{command}{'; beside: ' if rest else ''}{rest}")


def base_table(table: Table, robot: Robot, found: Physical) -> Table:
    """The base parameters of the new bodies, as `validate` takes them."""
    schema = pa.schema([pa.field("parameter", pa.string()), pa.field("unit", pa.string()),
                        number("estimate"), number("moved")])  # fmt: skip
    arrays = [
        pa.array(robot.names, pa.string()),
        pa.array([p.unit for p in robot.parameters], pa.string()),
        doubles(found.base),
        known(found.moved),
    ]
    batch = pa.RecordBatch.from_arrays(arrays, schema=schema)
    meta = replace(table.meta, kind="parameters", robot=robot.name, extra={})
    return Table("urdf", schema, meta, iter([batch]))


def told(robot: Robot, found: Physical) -> Iterator[str]:
    """How far the parameters had to move, and the bodies."""
    moved = np.nan_to_num(np.abs(found.moved))
    far = [i for i in np.argsort(-moved) if moved[i] > 1.0]
    if not far:
        yield f"such bodies exist: no parameter had to move by more than {moved.max():.2g} errors"
    else:
        names = ", ".join(f"{robot.names[i]} by {moved[i]:.2g}" for i in far[:5])
        more = ", ..." if len(far) > 5 else ""
        yield (
            f"{len(far)} of {len(moved)} parameters had to move by more than an error for bodies "
            f"that can exist: {names}{more}"
        )
    masses = ", ".join(f"{body[9]:.4g}" for body in found.bodies)
    yield f"masses {masses} kg; only combinations of them are identified"
