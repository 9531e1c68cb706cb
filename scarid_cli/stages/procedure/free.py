"""Identification with free gains: they are estimated from the log itself, and then corrected.

The gains of the joints come from the products of the rows of each joint, and what the log tells is
combined with what is known beforehand. The torques are divided by them, so that what the rest of
the procedure knows about a log holds again. That is done twice, because the residuals of the
first time contain what wrong gains leave.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from scarid_cli.algorithms.changes.known_load import BEFORE, Gains, alone, scaled
from scarid_cli.algorithms.inference.gains import KNOWN
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array, Numbers
from scarid_cli.errors import BadData, UsageFault
from scarid_cli.stages.procedure.blind import Prepared, estimated
from scarid_cli.stages.records.corrected import Correction, corrected
from scarid_cli.stages.results.products import products_of

ROUNDS = 2
FEWEST = 3  # first moments, by which the masses of a description are judged
CONSTANTS, MASSES = "constants", "masses"


@dataclass(frozen=True)
class Anchor:
    """What fixes the factor that all gains have in common.

    It is a `joint` (from 0) whose gain is 1; or, without one, the masses of the description, or
    that the gains are 1 within `error`, which is then needed. The error is that of each torque
    constant, as known beforehand; 0 if nothing is.
    """

    error: float
    joint: int | None = None
    masses: bool = False

    @classmethod
    def of(cls, text: str, error: float, joints: int) -> Anchor:
        """From what was given to --free-gains and --torque-gain-error."""
        if text == MASSES:
            return cls(error, masses=True)
        if text == CONSTANTS:
            if not error:
                raise UsageFault(
                    "--free-gains constants: state how well they are known (--torque-gain-error)"
                )
            return cls(error)
        if not text.isdigit() or not 1 <= int(text) <= joints:
            raise UsageFault(
                f"--free-gains {text}: give the number of a joint (1 to {joints}), masses or "
                "constants"
            )
        return cls(error, joint=int(text) - 1)


@dataclass(frozen=True)
class Freed:
    """The motion with corrected torques, and the correction; the joints (from 0) not told."""

    prepared: Prepared
    correction: Correction
    untold: list[int]


def freed(
    found: Prepared, robot: Robot, settings: Mapping[str, Any], initial: Array, anchor: Anchor
) -> Freed:
    """The prepared motion, with each torque divided by the gain that the motion tells."""
    batches = list(found.motion.batches)
    motion = replace(found.motion, batches=iter(batches))
    gains = None
    for _ in range(ROUNDS):
        table = estimated(replace(found, motion=motion), robot, settings, initial)
        gains, untold = _gains(table, robot, anchor)
        motion = corrected(replace(found.motion, batches=iter(batches)), gains.factors.tolist())
    assert gains
    made = Correction(gains.factors, gains.covariance)
    errors = replace(found.chosen.treatment, gain_errors=made.errors)
    chosen = replace(found.chosen, treatment=errors)
    return Freed(replace(found, motion=motion, chosen=chosen), made, untold)


def _gains(table: Any, robot: Robot, anchor: Anchor) -> tuple[Gains, list[int]]:
    """The gains by which the logged torques are to be divided, and the joints that stay as is."""
    judged = products_of(table, robot)
    error = anchor.error or BEFORE
    one = judged.products.strongest if anchor.masses else anchor.joint
    fixed = set() if one is None else {one}
    found = alone(judged, error, fixed)
    untold = [] if anchor.error else np.flatnonzero(found.errors > KNOWN).tolist()
    if untold:
        found = alone(judged, error, {*untold, *fixed})
    if anchor.masses:
        found = scaled(found, robot.apriori, _moments(robot), untold)
    return found, untold


def _moments(robot: Robot) -> Numbers:
    """The places of the first moments that a description states."""
    places = [i for i, p in enumerate(robot.parameters) if p.unit == "kg m" and p.apriori]
    if len(places) < FEWEST:
        raise BadData(
            f"{robot.name}: --free-gains masses: its description has {len(places)} first moments, "
            f"and needs {FEWEST}; give the number of a joint whose torque constant is known"
        )
    return np.array(places)
