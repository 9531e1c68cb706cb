"""The table of the gains of a robot's torques, from the parameters with and without a load."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from statistics import NormalDist

import numpy as np

from scarid_cli.algorithms.beyond.model import Model
from scarid_cli.algorithms.changes.known_load import Gains, Load, with_load
from scarid_cli.algorithms.changes.payload import directions
from scarid_cli.algorithms.inference.gains import KNOWN
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.logs import CURRENT
from scarid_cli.arrays import Array, Marks
from scarid_cli.errors import BadData
from scarid_cli.interval import HALF, plus_minus
from scarid_cli.io import schemas
from scarid_cli.io.table import Table, table_of
from scarid_cli.stages.payload import LOADED, frame_of, loaded
from scarid_cli.stages.records.corrected import gains_of
from scarid_cli.stages.results.parameters import GAINS
from scarid_cli.stages.results.products import products_of

CHANGED, CERTAINLY = 0.02, 6.0  # of a gain, and standard errors, by which it changed between logs
LEVEL = 0.05  # probability of calling any of the joints wrong if none is


@dataclass(frozen=True)
class Told:
    """The gains of the joints, and which of them the logs tell.

    `constants` (joints) are the torque constants that the logs were read with [N m/A], nan for a
    joint that has none of its own.
    """

    gains: Gains
    constants: Array

    @property
    def known(self) -> Marks:
        """Which gains are told (joints)."""
        return np.asarray(self.gains.errors < KNOWN, dtype=bool)

    @property
    def wrong(self) -> list[int]:
        """The joints (from 0) whose gain is not 1, beyond what noise makes of it."""
        most = NormalDist().inv_cdf(1.0 - 0.5 * LEVEL / len(self.constants))
        ratios = np.abs(self.gains.logarithms) / self.gains.errors
        return np.flatnonzero(self.known & (ratios > most)).tolist()


def load_in(
    robot: Robot,
    link: str | None,
    mass: tuple[float, float],
    centre: tuple[Sequence[float], float] | None,
) -> Load:
    """A load, given its mass [kg] and its centre [m] in the frame of a link, each with its error.

    The frame is by default that of the tool.
    """
    frame, _ = frame_of(robot, link, "gains need")
    if centre is None:
        return Load(*mass)
    place, error = centre
    return Load(*mass, frame.carried(place), error)


def gains(bare: Table, other: Table, robot: Robot, load: Load) -> Told:
    """The gains, from the tables of parameters of the bare robot and of the loaded one."""
    _require_same_gains(bare, other)
    shared = Model(robot, list(range(len(robot.names)))).transmits
    one, two = products_of(bare, robot), products_of(other, robot)
    found = with_load(one, two, directions(robot), shared, load)
    told = Told(found, _constants(robot))
    if not told.known.any():
        within = HALF * 100.0 * float(found.errors.min())
        centre = "" if load.centre is not None else ", or state its centre as well (--centre)"
        remedy = freed(bare) or (
            "use a motion that turns the joints against gravity and is longer or faster, with and "
            f"without the load{centre}"
        )
        raise BadData(
            f"gains: the motion tells none of them better than within {within:.2g} %; {remedy}"
        )
    return told


def freed(bare: Table) -> str:
    """What to do where the torques of the bare robot's log do not fit together; empty if they do.

    With a gain that is wrong in its parameters, these are too vague to tell any gain.
    """
    told = bare.meta.extra.get(GAINS) or {}
    if gains_of(bare) or all(
        abs(k - 1.0) < max(CHANGED, CERTAINLY * error) for k, error in told.values()
    ):
        return ""
    anchor = next((j for j in range(1, len(told) + 2) if str(j) not in told), 1)
    return (
        f"the torques of the bare robot's log do not fit together: identify it with `scarid "
        f"identify --free-gains {anchor}`, and give that table for --parameters"
    )


def _require_same_gains(bare: Table, loaded: Table) -> None:
    """Refuse logs between which a gain changed: what they say together is of neither."""
    one, other = (table.meta.extra.get(GAINS) or {} for table in (bare, loaded))
    if one.keys() != other.keys():  # relative to another joint
        return
    for joint, (factor, error) in one.items():
        ratio = other[joint][0] / factor
        known = float(np.hypot(error / factor, other[joint][1] / other[joint][0]))
        if abs(np.log(ratio)) > max(CHANGED, CERTAINLY * known):
            raise BadData(
                f"gains: with the load, the torque of joint {joint} is {ratio:.3g} times what it "
                "was without it, beside those of others: a gain changed between the logs; "
                "take both with the same drives, units and settings"
            )


def _constants(robot: Robot) -> Array:
    """The torque constants of the description (joints), nan where a motor turns several joints."""
    log, none = robot.log, np.full(len(robot.joints), np.nan)
    if log is None or log.torques != CURRENT:
        return none
    ratios = np.array(log.ratios)
    alone = np.count_nonzero(ratios, axis=0) == 1
    alone &= np.count_nonzero(ratios, axis=1) == 1
    return np.where(alone, log.constants, np.nan)


def table(found: Told, robot: Robot, of: Table, with_load: Table) -> Table:
    """A row for each joint, with its 95 % interval; empty where the gain is not told.

    From the parameters of the bare robot and of the loaded one.
    """
    k, errors = found.gains.factors, found.gains.errors
    span = np.exp(HALF * errors)
    columns = (k, k * errors, k / span, k * span, found.constants / k)
    rows = [
        (j, *(float(x[j - 1]) if found.known[j - 1] else np.nan for x in columns))
        for j in range(1, len(robot.joints) + 1)
    ]
    extra = {
        "covariance": found.gains.covariance.tolist(),
        "wrong": [j + 1 for j in found.wrong],
        LOADED: loaded(with_load),
    }
    meta = replace(of.meta, kind="gains", extra=extra)
    return table_of("gains", schemas.load("gains").arrow(), rows, meta)


def told(found: Told) -> Iterator[str]:
    """The gains, which of them are wrong, and what the motion does not tell."""
    parts = [f"joint {j + 1} {_gain(found.gains, j)}" for j in np.flatnonzero(found.known).tolist()]
    yield f"logged over true torque: {', '.join(parts)}"
    if found.wrong:
        k = found.gains.factors
        texts = [
            f"joint {j + 1} logs {abs(100.0 * (k[j] - 1.0)):.2g} % too "
            f"{'much' if k[j] > 1.0 else 'little'}"
            for j in found.wrong
        ]
        yield f"wrong: {', '.join(texts)} (its torque constant, gear ratio or unit)"
    else:
        yield "none of them differs from 1"
    if unknown := np.flatnonzero(~found.known).tolist():
        yield f"not told by this motion: joint {', '.join(str(j + 1) for j in unknown)}"


def _gain(gains: Gains, j: int) -> str:
    k = gains.factors[j]
    digits = max(1, 1 - int(np.floor(np.log10(HALF * k * gains.errors[j]))))
    return f"{k:.{digits}f} {plus_minus(float(k * gains.errors[j]))}"


def toml_lines(found: Told) -> str:
    """The [[joint]] entries of a TOML file, with the torque constants that make the gains 1.

    A joint whose log has torques gets a comment: a constant would not be read.
    """
    lines = ["# The torque constants that the gains of `scarid gains` make right."]
    if np.isnan(found.constants).any():
        lines += [
            "# A log that has torques reads no constants: multiply those that made them by the",
            "# factor, or give the table of gains to `scarid identify --gains`.",
        ]
    for j, constant in enumerate(found.constants):
        lines += ["", f"[[joint]]  # {j + 1}"]
        if not found.known[j]:
            lines.append("# not told")
            continue
        value, gain = 1.0 / found.gains.factors[j], f"gain {_gain(found.gains, j)}"
        if np.isfinite(constant):
            own = f"torque_constant = {constant * value:.5g}"
            lines.append(f"{own}  # N m/A, in place of {constant:g}; {gain}")
        else:
            lines.append(f"# times {value:.5g}; {gain}")
    return "\n".join([*lines, ""])
