"""What a robot carries over time: the pieces of a motion with one payload, and a trace of it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.changes.carried import BLOCK, SIZES, VARIES, Carrying, Piece, Sums
from scarid_cli.algorithms.changes.payload import directions, located
from scarid_cli.algorithms.effects.offsets import offset_joints
from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.algorithms.regression.treatment import Treatment
from scarid_cli.algorithms.robots.rigid import Frame
from scarid_cli.algorithms.robots.terms import Offset
from scarid_cli.arrays import Array, Marks
from scarid_cli.errors import bad_data
from scarid_cli.interval import HALF, plus_minus
from scarid_cli.io import schemas
from scarid_cli.io.table import Table, matrix, table_of
from scarid_cli.stages import Sink
from scarid_cli.stages.payload import frame_of
from scarid_cli.stages.results.changes import known
from scarid_cli.stages.results.estimates import Estimates
from scarid_cli.stages.results.prediction import predicted

NAMES = ("mass", "x", "y", "z")
HEAVIER, LIGHTER = "picked up", "put down"
TINY = 1e-9  # N m or N: the least size
UNTOLD = 0.5  # m: half an interval of a centre that is not told
CLEAR = 4.0  # standard errors of a mass, from which on something hangs there


@dataclass(frozen=True)
class Load:
    """Mass [kg] and centre [m] in a frame (4), and their standard errors."""

    values: Array
    errors: Array

    @property
    def shown(self) -> bool:
        """Whether there is a mass, without which there is no centre."""
        return bool(abs(self.values[0]) > CLEAR * self.errors[0])

    @property
    def hidden(self) -> Marks:
        """Which of x, y and z are not told: all of nothing, and what the motion does not show."""
        return np.asarray((HALF * self.errors[1:] > UNTOLD) | (not self.shown))

    @property
    def row(self) -> list[float]:
        """The values, and half their 95 % intervals; nan where they are not told."""
        values, half = self.values.copy(), HALF * self.errors
        hidden = self.hidden
        values[1:][hidden] = half[1:][hidden] = np.nan
        return [*values.tolist(), *half.tolist()]


@dataclass(frozen=True)
class Bare:
    """What is known of the bare robot: its estimates, and the deviation of its residuals (joints).

    `B` (parameters, 10 + frictions) is how the parameters depend on those of the payload, and on
    what friction and offsets change by; `sizes` are those that this may have. The `frame` is that
    of a `link`.
    """

    estimates: Estimates
    deviations: Array
    B: Array
    sizes: Array
    frame: Frame
    link: str

    @property
    def none(self) -> Sums:
        """The sums of no rows."""
        return Sums.none(self.sizes, len(self.estimates.values))

    @classmethod
    def of(cls, estimates: Estimates, table: Table, link: str | None) -> Bare:
        robot = estimates.robot
        frame, name = frame_of(robot, link, "a payload needs")
        evidence = known(table, robot, estimates.errors).evidence
        if evidence is None or not np.all(evidence.deviations > 0.0):
            raise bad_data(
                table.name,
                "nothing about the residuals of its log",
                expected="what `scarid identify` keeps in its table",
                remedy="identify the bare robot again with `scarid identify -o FILE.parquet`",
            )
        return cls(estimates, evidence.deviations, *_free(estimates), frame, name)

    def load(self, sums: Sums, noise: float) -> Load:
        """What the sums say, with the errors of the bare robot."""
        phi, covariance = sums.solved(noise)
        covariance = covariance + self._bare(sums, covariance / noise)
        values, errors = located(phi[:10], covariance[:10, :10], self.frame)
        return Load(values[:4], errors[:4])

    def _bare(self, sums: Sums, gain: Array) -> Array:
        """What the errors of the bare robot add to the covariance of the parameters."""
        own = np.nan_to_num(self.estimates.covariance)
        moved = gain @ sums.bare
        return np.asarray(moved @ own @ moved.T)


@dataclass
class Carried:
    """The pieces of a motion, from its blocks as they are complete."""

    bare: Bare
    found: Carrying
    sink: Sink

    def over(self, motion: Table, treatment: Treatment) -> Iterator[tuple[Piece, Load, Load]]:
        """Each change as it is found: the piece that begins, and the loads before and after."""
        schema = schemas.load("carried").arrow()
        meta = replace(motion.meta, kind="carried", robot=self.bare.estimates.robot.name)
        self.sink.start(replace(motion, schema=schema, meta=meta).arrow_schema())
        for start, end, block in self._blocks(motion, treatment):
            changed = self.found.add(start, end, block)
            self.sink.write(self._row(schema, end, changed=changed))
            if changed:
                before, after = self.found.pieces[-2:]
                yield after, self.of(before), self.of(after)

    def of(self, piece: Piece) -> Load:
        """The load of a piece."""
        return self.bare.load(piece.total, self.found.noise)

    def _row(self, schema: pa.Schema, t: float, *, changed: bool) -> pa.RecordBatch:
        values = [t, *self.of(self.found.last).row, float(changed)]
        return pa.RecordBatch.from_arrays(
            [pa.array([x], f.type, from_pandas=True) for x, f in zip(values, schema, strict=True)],
            schema=schema,
        )

    def _blocks(self, motion: Table, treatment: Treatment) -> Iterator[tuple[float, float, Sums]]:
        """The sums of each block of the motion, with its times [s]."""
        first = number = None
        sums = self.bare.none
        for batch, rows, (torques,) in predicted(motion, [self.bare.estimates.model], treatment):
            assert batch is not None  # nothing is decimated here
            t = matrix(batch, ["t"])[0]
            first = float(t[0]) if first is None else first
            numbers = ((t - first) / BLOCK + 1e-9).astype(np.int64)
            for own in np.unique(numbers).tolist():
                if number is not None and own != number:
                    yield first + number * BLOCK, first + (number + 1) * BLOCK, sums
                    sums = self.bare.none
                number = own
                sums = self._with(sums, rows, torques, numbers == own)

    def _with(self, sums: Sums, rows: Rows, torques: Array, chosen: Marks) -> Sums:
        weights = (rows.scales[chosen] > 0.0) / self.bare.deviations**2
        residual = rows.y[chosen] - torques.T[chosen]
        return sums.with_rows(rows.W[chosen], self.bare.B, residual, weights)


def _free(estimates: Estimates) -> tuple[Array, Array]:
    """How the parameters depend on those that are free, and the sizes that these may have."""
    robot, sizes = estimates.robot, np.abs(estimates.full)
    terms = [parameter.term for parameter in robot.parameters]
    free = [k for k, term in enumerate(terms) if term.FRICTION or isinstance(term, Offset)]
    for k, joint in offset_joints(robot).items():  # which may be 0: it changes with the friction
        own = [i for i, x in enumerate(terms) if x.JUMPS and x.joints == (joint + 1,)]
        sizes[k] = max(sizes[own], default=sizes[k])
    B = np.column_stack((directions(robot), np.eye(len(terms))[:, free]))
    return B, np.append(SIZES, np.maximum(VARIES * sizes[free], TINY))


def told(piece: Piece, before: Load, after: Load) -> str:
    """A change in a line."""
    change = float(after.values[0] - before.values[0])
    error = float(np.hypot(before.errors[0], after.errors[0]))
    what = HEAVIER if change > 0.0 else LIGHTER
    not_at = "" if piece.misplaced is None else f", not at {piece.misplaced:.4g} s as told before"
    return (
        f"{what} {abs(change):.3g} {plus_minus(error)} kg at {piece.start:.4g} s "
        f"(suspected at {piece.found:.4g} s){not_at}"
    )


def summary(piece: Piece, load: Load, link: str) -> str:
    """What hung there in a piece, in a line."""
    mass, half = float(load.values[0]), plus_minus(load.errors[0])
    when = f"from {piece.start:.4g} to {piece.end:.4g} s"
    if not load.shown:
        return f"{when} nothing more than the bare robot has ({mass:.3g} {half} kg)"
    if mass < 0.0:
        return f"{when} {-mass:.4g} {half} kg less than the bare robot has"
    own = zip(NAMES[1:], load.values[1:], load.errors[1:], load.hidden, strict=True)
    centre = [f"{name} {x:.3g} {plus_minus(e)} m" for name, x, e, hidden in own if not hidden]
    where = f"; in the frame of {link} {', '.join(centre)}" if centre else ""
    return f"{when} {mass:.4g} {half} kg{where}"


def pieces(carried: Carried, motion: Table) -> Table:
    """A row for each piece: from when to when, what hung there, and its centre."""
    own = carried.found.pieces
    if not own:
        raise bad_data(
            motion.name,
            f"less than {2.0 * BLOCK:g} s of settled rows",
            expected="blocks of a quarter of a second",
            remedy="give a longer log",
        )
    rows = [(x.start, x.end, x.found, *carried.of(x).row) for x in own]
    meta = replace(motion.meta, kind="loads", robot=carried.bare.estimates.robot.name)
    meta = replace(meta, extra={"frame": carried.bare.link})
    return table_of("payload", schemas.load("loads").arrow(), rows, meta)
