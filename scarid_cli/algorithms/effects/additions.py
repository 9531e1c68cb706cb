"""What the torques of a log clearly are beyond the model, fitted beside the parameters.

If one entry of the catalogue (beyond/) explains nearly all that the torques are beyond the model,
it is fitted with it: friction that grows with the load, for example, would otherwise make masses
larger. It is no parameter, because the robot has no such term, but goes with them where torques
are predicted.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from scarid_cli.algorithms.beyond.additions import Addition, gains
from scarid_cli.algorithms.beyond.catalogue import MISMATCHES, PHENOMENA
from scarid_cli.algorithms.beyond.gears import Gears
from scarid_cli.algorithms.beyond.model import Model
from scarid_cli.algorithms.beyond.mounting import Tilt
from scarid_cli.algorithms.beyond.signals import Signals
from scarid_cli.algorithms.beyond.torques import Cable, Offset, Ripple, Spring
from scarid_cli.algorithms.effects.explanations import Explanation
from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.arrays import Array

REFITS = 4  # gains of .6 are then as large at the next fit, to a tenth of their errors


def of_explanation(
    explanation: Explanation, rows: Rows, constant: Collection[int]
) -> tuple[Addition, ...]:
    """The additions of an explanation. The joints that are `constant` have an offset already.

    A spring is slack somewhere, so that it takes an offset.
    """
    usual = np.sqrt(np.mean(rows.motion[1] ** 2, axis=1))
    found = explanation.torques
    springs = (Spring.NAME, Cable.NAME)
    slack = {(Offset.NAME, j) for name, j in found if name in springs and j not in constant}
    parts = {
        (part.NAME, j, float(cycles))
        for name, j in found | slack
        for cycles in (explanation.cycles[:, j] if name == Ripple.NAME else [0.0])
        if cycles > 0.0 or name != Ripple.NAME
        for part in PHENOMENA[name].parts()
    }
    return tuple(
        Addition(name, j, 1.0 if name == Tilt.NAME else float(usual[j]), cycles=cycles)
        for name, j, cycles in sorted(parts)
    )


@dataclass(frozen=True)
class Shapes:
    """The shapes of additions, as they are with the parameters `theta` of the model."""

    additions: Sequence[Addition]
    model: Model
    theta: Array

    @property
    def possible(self) -> bool:
        """Whether there are additions of these sizes."""
        return all(addition.possible for addition in self.additions)

    @property
    def curved(self) -> bool:
        """Whether a column depends on the size that it gets."""
        return any(addition.mismatch for addition in self.additions)

    @property
    def refits(self) -> int:
        """The fits until columns that depend on the estimates beside them no longer change."""
        return REFITS if self.curved or any(x.entry.RELATIVE for x in self.additions) else 1

    @property
    def constant(self) -> list[int]:
        """The joints (from 0) that have an offset."""
        return [addition.joint for addition in self.additions if addition.name == Offset.NAME]

    def beside(self, rows: Rows) -> Rows:
        """The rows with the shapes as further columns."""
        return replace(rows, W=np.concatenate((rows.W, self.columns(rows)), axis=2))

    def compared(self, rows: Rows) -> Rows:
        """The rows as logs are compared: without their gains, beside what no comparison fits."""
        others = [addition for addition in self.additions if not addition.entry.COMPARED]
        wide = replace(self, additions=others).beside(rows) if others else rows
        tilts = replace(self, additions=[x for x in self.additions if x.name == Tilt.NAME])
        y = wide.y - tilts.torques(rows) if tilts.additions else wide.y
        return replace(wide, y=y / gains(self.additions, wide.y.shape[1]))

    def columns(self, rows: Rows) -> Array:
        """The shapes (samples, joints, additions)."""
        signals = Signals.of(rows, self.model, self.theta)
        signals = replace(signals, turns=signals.others > 0.0)  # those of the log that shows them
        gears, tilted = Gears(rows, self.model, self.theta), self._tilted(rows)
        columns = np.zeros((*rows.y.shape, len(self.additions)))
        for k, addition in enumerate(self.additions):
            if addition.name in MISMATCHES:
                kind, joint = MISMATCHES[addition.name], addition.joint
                columns[:, :, k] = kind.secant(gears, joint, addition.size)
            elif addition.name == Tilt.NAME:
                columns[:, :, k] = 0.0 if tilted is None else tilted[:, :, addition.joint]
            else:
                own = addition.of(signals)
                columns[:, addition.joint, k] = own[:, addition.joint]
        return columns

    def _tilted(self, rows: Rows) -> Array | None:
        """The columns of a base that is tilted, if it is; None without gravity."""
        own = [addition for addition in self.additions if addition.name == Tilt.NAME]
        if not own:
            return None
        sines = np.zeros(2)
        for addition in own:
            if addition.joint < len(sines):
                sines[addition.joint] = np.nan_to_num(addition.size)  # before the first fit
        return self.model.leaning(rows.motion[0], self.theta, sines)

    def torques(self, rows: Rows) -> Array:
        """The torques (samples, joints) of the additions that belong to the robot."""
        sizes = [addition.size if addition.lasts else 0.0 for addition in self.additions]
        return np.asarray(self.columns(rows) @ np.array(sizes))

    def sized(self, sizes: Array) -> tuple[Addition, ...]:
        """The additions, with the first of these sizes."""
        pairs = zip(self.additions, sizes.tolist(), strict=False)
        return tuple(replace(addition, size=size) for addition, size in pairs)
