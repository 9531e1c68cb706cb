"""The residual torque of each row beside the band that it stays in unless something touches.

`scarid validate --residual` writes it. The band of a joint has two parts, whose squares add up:
half the 95 % interval of the predicted torque at that row, which the errors of the parameters
give, and the level that the residuals pass as rarely as is asked for (uncertainty/peaks.py), which
noise and all that the model lacks give, as they were in the log of the identification.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.changes.wording import CHANGED
from scarid_cli.algorithms.regression.momentum import Observer
from scarid_cli.algorithms.regression.normal_equations import inverse
from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.uncertainty.jackknife import quantile
from scarid_cli.algorithms.uncertainty.peaks import Peaks
from scarid_cli.arrays import Array
from scarid_cli.errors import bad_data
from scarid_cli.io.table import (
    Table,
    integers,
    matrix,
    number,
    numbers,
    segment_field,
    with_columns,
)
from scarid_cli.stages import Sink
from scarid_cli.stages.results.changes import Known
from scarid_cli.stages.results.parameters import Identified
from scarid_cli.stages.results.prediction import Part, of_parts
from scarid_cli.words import of_joints

SHOWN = 3  # contacts that a message names at most
GAP = 0.1  # s without a contact, by which two of them are apart
MOST = 1000  # contacts that are listed


@dataclass(frozen=True)
class Band:
    """`levels` (joints) [N m or N], and a root of the covariance of the estimates, R R' (p, p).

    `factor` is half the 95 % interval in standard errors.
    """

    levels: Array
    root: Array
    factor: float

    def at(self, W: Array) -> Array:
        """Half the width of the band (samples, joints) [N m or N] at rows of the regressor."""
        wide = self.factor**2 * np.sum((W @ self.root) ** 2, axis=2)
        return np.asarray(np.sqrt(wide + self.levels**2))


def band_of(tables: Sequence[Table], before: Known, robot: Robot, rate: float) -> Band:
    """The band that all joints together leave `rate` times in an hour [1/h] by chance."""
    joints = len(robot.joints)
    levels = np.max([_levels(table, before, joints, rate) for table in tables], axis=0)
    evidence = before.evidence
    assert evidence is not None  # _levels refuses tables without it
    covariance = before.covariance
    if covariance is None:
        own = slice(len(robot.parameters))
        covariance = inverse(evidence.information[own, own])
    values, vectors = np.linalg.eigh(covariance)
    root = vectors * np.sqrt(values.clip(min=0.0))
    return Band(levels, root, quantile(0.975, evidence.blocks - 1.0))


def _levels(table: Table, before: Known, joints: int, rate: float) -> Array:
    found = [(x.get("peak"), x.get("peak_scale")) for x in table.meta.extra.get("joints", [])]
    if len(found) != joints or before.evidence is None or any(None in pair for pair in found):
        raise bad_data(
            table.name,
            "nothing about the largest residuals of its log",
            expected="what `scarid identify` keeps of a log of 5 s or more",
            remedy="identify the log again with `scarid identify -o FILE.parquet`",
        )
    blocks = before.evidence.blocks
    return np.array([Peaks(*map(float, pair)).level(rate / joints, blocks) for pair in found])


@dataclass
class Contact:
    """From `start` to `end` [s] a residual was beyond its band, most at `joint` (from 1)."""

    start: float
    end: float
    joint: int
    ratio: float

    def also(self, t: float, joint: int, ratio: float) -> None:
        self.end = t
        if ratio > self.ratio:
            self.joint, self.ratio = joint, ratio


@dataclass
class Residuals:
    """Writes the residual and the band of each row to a sink, and keeps where they were beyond."""

    band: Band
    robot: Robot
    sink: Sink
    rate: float  # of false alarms [1/h]
    observer: float | None = None  # Hz
    contacts: list[Contact] = field(default_factory=list)
    count: int = 0
    nearest: Contact | None = None  # the row with the largest residual, in its band or beyond
    _schema: pa.Schema | None = None

    def watched(self, parts: Iterator[Part], model: Identified, table: Table) -> Iterator[Part]:
        """The parts of the rows of a motion, whose residuals are written as they pass."""
        self._start(table)
        passed: deque[Part] = deque()
        own = _kept(parts, passed)
        if self.observer:
            own = self._observed(own, model, Observer(self.robot, self.observer, table.period))
            model = replace(model, additions=())
        for batch, rows, (torques,) in of_parts(own, [model], table.period):
            self._add(batch, rows, torques)
            while passed:
                yield passed.popleft()
        yield from passed

    def _observed(
        self, parts: Iterator[Part], model: Identified, observer: Observer
    ) -> Iterator[Part]:
        # What needs the rows around its own would depend on how they arrive.
        own = [addition for addition in model.additions if not addition.mismatch]
        beside = replace(model.shapes, additions=own)
        for batch, rows in parts:
            torques = beside.torques(rows) if own else 0.0
            yield batch, observer(replace(rows, y=rows.y - torques))

    def _start(self, table: Table) -> None:
        units = [joint.torque_unit for joint in self.robot.joints]
        columns = (*numbers("tau{i}_residual", units), *numbers("tau{i}_band", units))
        contact = pa.field("contact", pa.int64())
        self._schema = pa.schema([number("t", "s"), *columns, contact, *segment_field(table)])
        meta = replace(table.meta, kind="residual", robot=self.robot.name)
        self.sink.start(replace(table, schema=self._schema, meta=meta).arrow_schema())

    def _add(self, batch: pa.RecordBatch | None, rows: Rows, torques: Array) -> None:
        """Write the next rows; `torques` (joints, samples) are the predicted ones."""
        assert self._schema is not None
        assert batch is not None  # rows that are decimated have none, and are refused before
        residual, band = rows.y - torques.T, self.band.at(rows.W)
        # A joint whose row is left out of the fit, as near a reversal, is not judged.
        band[rows.scales == 0.0] = np.nan
        ratios = np.nan_to_num(np.abs(residual) / band)
        joints = np.argmax(ratios, axis=1)
        largest = ratios[np.arange(len(ratios)), joints]
        beyond = largest > 1.0
        self._note(matrix(batch, ["t"])[0], joints + 1, largest)
        values: list[Any] = [*residual.T, *band.T, integers(np.where(beyond, joints + 1, 0))]
        new = dict(zip(self._schema.names[1 : len(values) + 1], values, strict=True))
        self.sink.write(with_columns(batch, self._schema, new))

    def _note(self, t: Array, joints: Array, ratios: Array) -> None:
        if not len(t):
            return
        k = int(np.argmax(ratios))
        if self.nearest is None or ratios[k] > self.nearest.ratio:
            self.nearest = Contact(float(t[k]), float(t[k]), int(joints[k]), float(ratios[k]))
        for i in np.flatnonzero(ratios > 1.0).tolist():
            now, joint, ratio = float(t[i]), int(joints[i]), float(ratios[i])
            last = self.contacts[-1] if self.contacts else None
            if last and 0.0 <= now - last.end <= GAP:
                last.also(now, joint, ratio)
                continue
            self.count += 1
            if self.count <= MOST:
                self.contacts.append(Contact(now, now, joint, ratio))

    @property
    def extra(self) -> dict[str, Any]:
        """For the metadata of the metrics."""
        listed = [vars(contact) for contact in self.contacts]
        return {"contacts": self.count, "contact": listed}

    def told(self, change: dict[str, Any] | None) -> list[str]:
        """The contacts in a line, or that there is none."""
        return [_in_words(self, change)]


def _kept(parts: Iterator[Part], passed: deque[Part]) -> Iterator[Part]:
    """The parts, each of which is kept for the next one who wants it."""
    for part in parts:
        passed.append(part)
        yield part


def _in_words(found: Residuals, change: dict[str, Any] | None) -> str:
    levels = _levels_in_words(found.band.levels, found.robot)
    chance = f"by chance alone {found.rate:g} in an hour of motion"
    if not found.count:
        near = found.nearest
        most = f"; the largest is {near.ratio:.2g} of it (joint {near.joint}" if near else ""
        at = f", t = {near.start:.6g} s)" if near else ""
        nothing = f"no contact: no residual is beyond its band ({chance})"
        return f"{nothing}{most}{at}; the band is at least {levels}"
    named = [_sentence(contact) for contact in found.contacts[:SHOWN]]
    more = [f"{found.count - SHOWN} more"] if found.count > SHOWN else []
    told = f"contact: {'; '.join([*named, *more])} ({chance})"
    if change and change["verdict"] == CHANGED:
        told += "; as the robot has changed, this may be no contact: identify it again"
    return told


def _sentence(contact: Contact) -> str:
    when = f"from t = {contact.start:.6g} to {contact.end:.6g} s"
    if contact.start == contact.end:
        when = f"at t = {contact.start:.6g} s"
    return f"joint {contact.joint} {when}, up to {contact.ratio:.2g} times its band"


def _levels_in_words(levels: Array, robot: Robot) -> str:
    units = [joint.torque_unit for joint in robot.joints]
    values = [f"{level:.2g}" for level in levels]
    if len(set(units)) == 1:
        return of_joints(values, f" {units[0]}")
    return of_joints([f"{value} {unit}" for value, unit in zip(values, units, strict=True)])
