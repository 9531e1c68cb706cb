"""Kinds of faults of a log, each drawn at random: joint, size, rows. See `spoiled.py`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.random import Generator
from spoiled import (
    clipped,
    coarse,
    copied,
    dead,
    deadened,
    degrees,
    frozen,
    held,
    jittered,
    joints_swapped,
    late,
    mostly_still,
    positions_times,
    time_in,
    torques_swapped,
    torques_times,
    turned,
    with_velocities,
    wrapped,
)

from scarid_cli.algorithms.checks.log import Log

Spoils = Callable[[Log], Log]
Draw = Callable[[Log, Generator], tuple[Spoils, str]]
"""A log and a source of chance give what is done to the log, and words that must be said."""


@dataclass(frozen=True)
class Kind:
    """The check that must name the fault, how it is drawn, and the robots that can show it."""

    check: str
    draw: Draw
    robots: tuple[str, ...] = ("scara", "arm", "pendulum", "ur10", "ur10e", "panda")


SIX = ("ur10", "ur10e", "panda")


def any_joint(log: Log, rng: Generator) -> int:
    return int(rng.integers(1, log.joints + 1))


def only(log: Log, joint: int, factor: float) -> list[float]:
    """This factor for one joint, 1 for the others."""
    return [factor if i == joint else 1.0 for i in range(1, log.joints + 1)]


def one_torque_reversed(log: Log, rng: Generator) -> tuple[Spoils, str]:
    joint = any_joint(log, rng)
    return torques_times(*only(log, joint, -1.0)), f"torque of joint {joint} by -1"


def all_torques_reversed(log: Log, _: Generator) -> tuple[Spoils, str]:
    return torques_times(*[-1.0] * log.joints), "torques' sign seems reversed"


def one_position_reversed(log: Log, rng: Generator) -> tuple[Spoils, str]:
    """What is behind a joint may be as good as symmetric: its torque may be named as well."""
    joint = any_joint(log, rng)
    return positions_times(*only(log, joint, -1.0)), f"of joint {joint} "


def pair(log: Log, rng: Generator) -> tuple[int, int]:
    one, two = sorted(rng.choice(np.arange(1, log.joints + 1), 2, replace=False))
    return int(one), int(two)


def torques_exchanged(log: Log, rng: Generator) -> tuple[Spoils, str]:
    one, two = pair(log, rng)
    return torques_swapped(one, two), f"joints {one}, {two}"


def joints_exchanged(log: Log, rng: Generator) -> tuple[Spoils, str]:
    one, two = pair(log, rng)
    return joints_swapped(one, two), f"joints {one}, {two} exchanged"


def one_position_twice(log: Log, rng: Generator) -> tuple[Spoils, str]:
    one, two = pair(log, rng)
    return copied(two, one), f"q{two} is q{one} in all"


def another_zero(log: Log, rng: Generator) -> tuple[Spoils, str]:
    """Not of the one at the base: that is another direction of gravity, or shows in no torque."""
    joint = int(rng.integers(2, log.joints + 1))
    angle = rng.choice([-0.5 * np.pi, 0.5 * np.pi, np.pi])
    return turned(joint, float(angle)), f"joint {joint} at"


def in_ms(_: Log, rng: Generator) -> tuple[Spoils, str]:
    unit, factor = [("ms", 1e3), ("us", 1e6), ("ns", 1e9)][rng.integers(3)]
    return time_in(factor), f"in {unit}"


def scaled_torques(log: Log, rng: Generator) -> tuple[Spoils, str]:
    """Currents, or per cent: one factor each, far from 1."""
    factor = float(rng.choice([0.03, 0.1, 0.3, 3.0, 10.0, 30.0]))
    each = factor * rng.uniform(0.8, 1.25, log.joints)
    return torques_times(*each), "what the described masses need"


def one_scaled_torque(log: Log, rng: Generator) -> tuple[Spoils, str]:
    joint = any_joint(log, rng)
    factor = float(rng.choice([0.03, 0.1, 0.3, 3.0, 10.0, 30.0]))
    return torques_times(*only(log, joint, factor)), f"the torque of joint {joint} is"


def of_a_column(log: Log, rng: Generator) -> str:
    return f"{rng.choice(['q', 'tau'])}{any_joint(log, rng)}"


def wrapping_angle(log: Log, rng: Generator) -> tuple[Spoils, str]:
    """Of the joint that turns furthest: in rad, degrees, turns or counts."""
    joint = int(np.ptp(log.q, axis=1).argmax()) + 1
    modulus, unit = [(2 * np.pi, 1.0), (360.0, 180 / np.pi), (1.0, 0.5 / np.pi), (65536.0, 1e4)][
        rng.integers(4)
    ]
    return wrapped(joint, modulus, unit), f"q{joint} leaps"


def position_glitches(log: Log, rng: Generator) -> tuple[Spoils, str]:
    return glitches(log, rng, "q", float(rng.uniform(0.1, 2.0)))


def torque_glitches(log: Log, rng: Generator) -> tuple[Spoils, str]:
    return glitches(log, rng, "tau", float(rng.uniform(3.0, 20.0)))


def glitches(log: Log, rng: Generator, name: str, size: float) -> tuple[Spoils, str]:
    """One to five single rows; of a torque in ranges of it, of a position in rad."""
    joint, rows = any_joint(log, rng), np.sort(rng.integers(50, log.rows - 50, rng.integers(1, 6)))
    rows = rows[np.diff(rows, prepend=-9) > 8]

    def spoil(log: Log) -> Log:
        x = getattr(log, name).copy()
        off = size if name == "q" else size * np.ptp(x[joint - 1])
        x[joint - 1, rows] += off * rng.choice([-1.0, 1.0], len(rows))
        return replace(log, **{name: x})

    return spoil, f"{name}{joint} leaps away"


def whole_seconds(_: Log, rng: Generator) -> tuple[Spoils, str]:
    """A clock that is exported in steps of .1 to 1 s."""
    step = float(rng.choice([0.1, 0.5, 1.0]))
    return lambda log: replace(log, t=step * np.floor(log.t / step)), "time of the row before"


def wrong_clock(log: Log, rng: Generator) -> tuple[Spoils, str]:
    """All measured velocities off by one factor."""
    factor = float(rng.choice([0.5, 0.8, 1.25, 2.0, 4.0]))
    return with_velocities(*[factor] * log.joints), "times the changes of the positions"


def wrong_rate(_: Log, rng: Generator) -> tuple[Spoils, str]:
    """A clock wrong by a factor, in a log without velocities."""
    factor = float(rng.choice([0.5, 0.8, 1.25, 2.0, 4.0]))
    return lambda log: replace(log, t=factor * log.t), "times that of the log"


def behind_a_gear(log: Log, rng: Generator) -> tuple[Spoils, str]:
    """Of an inner joint: of a vertical first and a round last one no torque tells it."""
    joint = int(rng.integers(2, log.joints)) if log.joints > 2 else any_joint(log, rng)
    factor = float(rng.choice([0.5, 2.0, 3.0, 10.0]))
    return positions_times(*only(log, joint, factor)), f"position of joint {joint} times"


def inner(log: Log, rng: Generator) -> int:
    """A joint whose axis is parallel to that of the joint before it."""
    return int(rng.integers(3, 5)) if log.joints > 2 else 2


def added(signals: str, to: int, of: int) -> Spoils:
    """To a signal of joint `to`, q or tau, that of joint `of` is added."""

    def spoil(log: Log) -> Log:
        values = getattr(log, signals).copy()
        values[to - 1] += values[of - 1]
        return replace(log, **{signals: values})

    return spoil


def from_the_base(log: Log, rng: Generator) -> tuple[Spoils, str]:
    joint = inner(log, rng)
    spoil = added("q", joint, joint - 1)
    return spoil, f"position of joint {joint} less that of joint {joint - 1}"


def of_a_belt(log: Log, _: Generator) -> tuple[Spoils, str]:
    joint = min(3, log.joints)
    spoil = added("tau", joint - 1, joint)
    return spoil, f"torque of joint {joint - 1} less that of joint {joint}"


def velocity_units(log: Log, rng: Generator) -> tuple[Spoils, str]:
    unit, factor = [("deg/s", 180 / np.pi), ("rpm", 30 / np.pi)][rng.integers(2)]
    return with_velocities(*[factor] * log.joints), f"in {unit}"


def velocity_reversed(log: Log, rng: Generator) -> tuple[Spoils, str]:
    joint = any_joint(log, rng)
    return with_velocities(*only(log, joint, -1.0)), f"velocity of joint {joint} has the other sign"


def velocities_exchanged(log: Log, rng: Generator) -> tuple[Spoils, str]:
    one, two = pair(log, rng)
    order = list(range(log.joints))
    order[one - 1], order[two - 1] = two - 1, one - 1
    return with_velocities(*[1.0] * log.joints, order=tuple(order)), f"joints {one}, {two} are"


def rows_missing(_: Log, rng: Generator) -> tuple[Spoils, str]:
    share = float(rng.choice([0.005, 0.02, 0.1]))
    return lambda log: log.part(rng.random(log.rows) > share), "rows in"


def time_back(_: Log, rng: Generator) -> tuple[Spoils, str]:
    """A second run behind the first, whose clock begins again."""

    def spoil(log: Log) -> Log:
        half = int(rng.integers(log.rows // 3, 2 * log.rows // 3))
        t = log.t.copy()
        t[half:] -= t[half]
        return replace(log, t=t)

    return spoil, "goes back in 1 place"


def not_a_number(log: Log, rng: Generator) -> tuple[Spoils, str]:
    joint, count = any_joint(log, rng), int(rng.integers(1, 50))

    def spoil(log: Log) -> Log:
        tau = log.tau.copy()
        tau[joint - 1, 100 : 100 + count] = np.nan
        return replace(log, tau=tau)

    return spoil, f"{count} cell"


KINDS = {
    "positions in degrees": Kind("positions", lambda *_: (degrees, "degrees")),
    "time in ms, us or ns": Kind("rate", in_ms),
    "clock in steps of .1 to 1 s": Kind("clock", whole_seconds),
    "clock wrong by a factor": Kind("clock", wrong_clock),
    "clock that begins again": Kind("time order", time_back),
    "velocities in deg/s or rpm": Kind("velocities", velocity_units),
    "one velocity reversed": Kind("velocities", velocity_reversed),
    "two velocities exchanged": Kind("velocities", velocities_exchanged),
    "all torques reversed": Kind("signs", all_torques_reversed),
    "one torque reversed": Kind("signs", one_torque_reversed),
    "one position reversed": Kind("signs", one_position_reversed, ("arm", *SIX)),
    "two torques exchanged": Kind("order of joints", torques_exchanged),
    "two joints exchanged": Kind("order of joints", joints_exchanged),
    "a zero a quarter or half turn away": Kind("zeros", another_zero, ("arm", "pendulum", *SIX)),
    "clock wrong by a factor, no velocities": Kind(
        "clock", wrong_rate, ("arm", "pendulum", "ur10", "panda")
    ),
    "a position behind a gear": Kind("gears", behind_a_gear, ("arm", *SIX)),
    "positions measured from the base": Kind("couplings", from_the_base, ("arm", "ur10", "ur10e")),
    "torques of a belt": Kind("couplings", of_a_belt, ("arm", "ur10", "ur10e")),
    "torques times .03 to 30": Kind("scale", scaled_torques),
    "one torque times .03 to 30": Kind("scale", one_scaled_torque),
    "an angle that wraps": Kind("wraps", wrapping_angle),
    "positions that leap and return": Kind("glitches", position_glitches),
    "torques that leap and return": Kind("glitches", torque_glitches),
    "cells without a number": Kind("missing values", not_a_number),
    "rows missing": Kind("missing rows", rows_missing),
    "jitter": Kind("jitter", lambda *_: (jittered, "resample")),
    "rows held": Kind(
        "held samples", lambda _, rng: (held(int(rng.integers(2, 6))), "with all values")
    ),
    "a torque that saturates": Kind(
        "saturation", lambda _, rng: (clipped(float(rng.uniform(0.4, 0.8))), "torque of joint 1")
    ),
    "a position logged twice": Kind("equal positions", one_position_twice),
    "a torque that is not logged": Kind(
        "constant torque",
        lambda log, rng: (dead(joint := any_joint(log, rng)), f"joint {joint} never changes"),
    ),
    "small torques not reported": Kind(
        "dead zone",
        lambda log, rng: (
            deadened(joint := any_joint(log, rng), float(rng.uniform(0.6, 0.9))),
            f"joint {joint} is one and the same",
        ),
    ),
    "a joint that is braked": Kind(
        "motion",
        lambda log, rng: (frozen(joint := any_joint(log, rng)), f"joint {joint} hardly moves"),
    ),
    "robot that stands most of the time": Kind(
        "standstill", lambda *_: (mostly_still, "cut the log")
    ),
    "torques 4 to 12 rows late": Kind(
        "delay", lambda _, rng: (late(int(rng.integers(4, 13))), "lag by")
    ),
    "coarse encoders": Kind(
        "resolution", lambda _, rng: (coarse(2 * np.pi / 2 ** int(rng.integers(6, 9))), "coarse")
    ),
}
