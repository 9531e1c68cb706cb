"""Logs with one known fault each, made from clean ones, and what `scarid check` must say of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from scarid_cli.algorithms.checks.log import Log


@dataclass(frozen=True)
class Spoiled:
    """A fault: the clean log it is made from, what is done to that, the robot, and what is said.

    `check` is the name of the finding that has to name the fault, and `says` words of it.
    """

    source: str
    spoil: Callable[[Log], Log]
    check: str
    says: str
    robot: str | None = None


def degrees(log: Log) -> Log:
    return replace(log, q=np.degrees(log.q))


def time_in(factor: float) -> Callable[[Log], Log]:
    return lambda log: replace(log, t=factor * log.t)


def torques_times(*factors: float) -> Callable[[Log], Log]:
    return lambda log: replace(log, tau=np.array(factors)[:, None] * log.tau)


def positions_times(*factors: float) -> Callable[[Log], Log]:
    return lambda log: replace(log, q=np.array(factors)[:, None] * log.q)


def turned(joint: int, angle: float) -> Callable[[Log], Log]:
    """The zero of a joint is so far [rad] from that of the description."""

    def spoil(log: Log) -> Log:
        q = log.q.copy()
        q[joint - 1] += angle
        return replace(log, q=q)

    return spoil


def torques_swapped(one: int, two: int) -> Callable[[Log], Log]:
    return lambda log: replace(log, tau=log.tau[_order(log, one, two)])


def joints_swapped(one: int, two: int) -> Callable[[Log], Log]:
    def spoil(log: Log) -> Log:
        order = _order(log, one, two)
        return replace(log, q=log.q[order], tau=log.tau[order])

    return spoil


def _order(log: Log, one: int, two: int) -> list[int]:
    order = list(range(log.joints))
    order[one - 1], order[two - 1] = order[two - 1], order[one - 1]
    return order


def clipped(part: float) -> Callable[[Log], Log]:
    """The torque of joint 1 limited to a part of its greatest value."""

    def spoil(log: Log) -> Log:
        tau = log.tau.copy()
        limit = part * np.abs(tau[0]).max()
        tau[0] = np.clip(tau[0], -limit, limit)
        return replace(log, tau=tau)

    return spoil


def held(every: int) -> Callable[[Log], Log]:
    """A sensor that is read every so many rows."""

    def spoil(log: Log) -> Log:
        at = np.arange(log.rows) // every * every
        return replace(log, q=log.q[:, at], tau=log.tau[:, at])

    return spoil


def some_held(log: Log) -> Log:
    """One row in eighteen is that before it."""
    at = np.arange(log.rows)
    at[17::18] -= 1
    return replace(log, q=log.q[:, at], tau=log.tau[:, at])


def without_rows(log: Log) -> Log:
    lost = np.random.default_rng(1).random(log.rows) < 0.01
    return log.part(~lost)


def with_pause(log: Log) -> Log:
    """Two seconds that are missing."""
    return log.part((log.t < 5.0) | (log.t > 7.0))


def repeated_times(log: Log) -> Log:
    t = log.t.copy()
    t[50::100] = t[49::100][: len(t[50::100])]
    return replace(log, t=t)


def time_going_back(log: Log) -> Log:
    at = np.arange(log.rows)
    at[1000], at[1001] = at[1001], at[1000]
    return log.part(at)


def jittered(log: Log) -> Log:
    h = log.t[1] - log.t[0]
    return replace(log, t=log.t + np.random.default_rng(2).uniform(-0.3, 0.3, log.rows) * h)


def with_nan(log: Log) -> Log:
    tau = log.tau.copy()
    tau[-1, 300:330] = np.nan
    return replace(log, tau=tau)


def mostly_still(log: Log) -> Log:
    """The robot waits three times as long as it moves, with the noise of its sensors."""
    count = 3 * log.rows
    rng = np.random.default_rng(3)
    noise = 1e-5 * rng.standard_normal((2 * log.joints, count))
    still = log.signals[:, -1:] + noise * np.max(np.abs(log.signals), axis=1)[:, None]
    signals = np.concatenate((log.signals, still), axis=1)
    h = log.t[1] - log.t[0]
    return Log(h * np.arange(4 * log.rows), signals[: log.joints], signals[log.joints :])


def late(rows: int) -> Callable[[Log], Log]:
    """The torques of so many rows ago."""
    return lambda log: Log(log.t[rows:], log.q[:, rows:], log.tau[:, :-rows])


def coarse(step: float) -> Callable[[Log], Log]:
    return lambda log: replace(log, q=step * np.round(log.q / step))


def frozen(joint: int) -> Callable[[Log], Log]:
    """A joint that is braked, with the noise of its encoder and what is left of its torque."""

    def spoil(log: Log) -> Log:
        q = log.q.copy()
        rng = np.random.default_rng(4)
        q[joint - 1] = q[joint - 1, 0] + 1e-5 * rng.standard_normal(log.rows)
        return replace(log, q=q)

    return spoil


def dead(joint: int) -> Callable[[Log], Log]:
    """A torque that was not logged."""

    def spoil(log: Log) -> Log:
        tau = log.tau.copy()
        tau[joint - 1] = 0.0
        return replace(log, tau=tau)

    return spoil


def copied(joint: int, of: int) -> Callable[[Log], Log]:
    """A recorder that writes the position of another joint for that of a joint."""

    def spoil(log: Log) -> Log:
        q = log.q.copy()
        q[joint - 1] = q[of - 1]
        return replace(log, q=q)

    return spoil


def deadened(joint: int, share: float) -> Callable[[Log], Log]:
    """A drive that reports the smaller ones of the torques, this share of the rows, as 0."""

    def spoil(log: Log) -> Log:
        tau = log.tau.copy()
        least = np.quantile(np.abs(tau[joint - 1]), share)
        tau[joint - 1, np.abs(tau[joint - 1]) < least] = 0.0
        return replace(log, tau=tau)

    return spoil


def wrapped(joint: int, modulus: float, unit: float = 1.0) -> Callable[[Log], Log]:
    """An angle in this unit [per rad] that wraps between where it begins and its highest value."""

    def spoil(log: Log) -> Log:
        q = log.q.copy()
        x = unit * q[joint - 1]
        edge = 0.5 * (x[0] + x.max())
        q[joint - 1] = (x - edge) % modulus + edge - modulus
        return replace(log, q=q)

    return spoil


def leapt(name: str, joint: int, size: float) -> Callable[[Log], Log]:
    """Three single readings of a column, q or tau, that are so far off."""

    def spoil(log: Log) -> Log:
        x = getattr(log, name).copy()
        x[joint - 1, [401, 1203, 2405]] += size
        return replace(log, **{name: x})

    return spoil


def with_velocities(*factors: float, order: tuple[int, ...] = ()) -> Callable[[Log], Log]:
    """Measured velocities, times factors, in this order of the joints (from 0)."""

    def spoil(log: Log) -> Log:
        dq = np.gradient(log.q, log.t, axis=1) * np.array(factors)[:, None]
        return replace(log, dq=dq[list(order)] if order else dq)

    return spoil


SPOILED = {
    "degrees": Spoiled("scara", degrees, "positions", "degrees"),
    "degrees, six joints": Spoiled("ur10", degrees, "positions", "degrees"),
    "time in ms": Spoiled("scara", time_in(1e3), "rate", "in ms"),
    "time in us": Spoiled("emps", time_in(1e6), "rate", "in us"),
    "all torques reversed": Spoiled(
        "scara", torques_times(-1.0, -1.0), "signs", "the torques' sign seems reversed"
    ),
    "all torques reversed, gravity": Spoiled(
        "arm", torques_times(-1.0, -1.0), "signs", "the torques' sign seems reversed"
    ),
    "torque of joint 2 reversed": Spoiled(
        "scara", torques_times(1.0, -1.0), "signs", "multiply the torque of joint 2 by -1"
    ),
    "torque of joint 3 of 6 reversed": Spoiled(
        "ur10", torques_times(1, 1, -1, 1, 1, 1), "signs", "multiply the torque of joint 3 by -1"
    ),
    "torques of joints 4 to 6 of 6 reversed": Spoiled(
        "ur10",
        torques_times(1, 1, 1, -1, -1, -1),
        "signs",
        "multiply the torque of joints 4, 5, 6 by -1",
    ),
    "position of joint 1 reversed": Spoiled(
        "arm", positions_times(-1.0, 1.0), "signs", "multiply the position of joint 1 by -1"
    ),
    "joints 1 and 2 exchanged": Spoiled(
        "scara", joints_swapped(1, 2), "order of joints", "joints 1, 2 exchanged"
    ),
    "torques 2 and 3 of 6 exchanged": Spoiled(
        "ur10", torques_swapped(2, 3), "order of joints", "torques of joints 2, 3 exchanged"
    ),
    "zero of joint 1 a quarter turn away": Spoiled(
        "pendulum", turned(1, 0.5 * np.pi), "zeros", "joint 1 at -90 degrees"
    ),
    "zero of joint 2 of 6 a half turn away": Spoiled(
        "ur10", turned(2, np.pi), "zeros", "joint 2 at 180 degrees"
    ),
    "torque clipped": Spoiled("scara", clipped(0.6), "saturation", "torque of joint 1 stays"),
    "every fourth row read": Spoiled("scara", held(4), "held samples", "with all values"),
    "5.6 % of the rows held": Spoiled("emps", some_held, "held samples", "5.5 %"),
    "1 % of the rows missing": Spoiled(
        "scara", without_rows, "missing rows", "39 rows in 39 places"
    ),
    "two seconds missing": Spoiled("arm", with_pause, "missing rows", "splits the log"),
    "repeated times": Spoiled("scara", repeated_times, "time order", "40 repeated times"),
    "time going back": Spoiled("scara", time_going_back, "time order", "goes back in 1 place"),
    "jitter": Spoiled("emps", jittered, "jitter", "scarid resample"),
    "cells without a number": Spoiled("scara", with_nan, "missing values", "30 cells"),
    "another robot, of two joints": Spoiled("arm", lambda log: log, "model", "is this ", "scara"),
    "another robot, with gravity": Spoiled(
        "scara", lambda log: log, "model", "is this ", "pendulum"
    ),
    "torques in mN m": Spoiled("arm", torques_times(1e3, 1e3), "torques", "in mN m"),
    "torques in mN m, no limits": Spoiled("scara", torques_times(1e3, 1e3), "scale", "in mN m"),
    "currents, 10 and 7 N m/A": Spoiled("arm", torques_times(0.1, 1 / 7), "scale", "currents"),
    "torques in percent": Spoiled("pendulum", torques_times(12.0, 25.0), "scale", "percent"),
    "torques three times too large": Spoiled("scara", torques_times(3.0, 3.0), "scale", "currents"),
    "currents of joint 2 of 6": Spoiled(
        "ur10", torques_times(1.0, 0.03, 1.0, 1.0, 1.0, 1.0), "scale", "the torque of joint 2"
    ),
    "angle that wraps": Spoiled("scara", wrapped(1, 2 * np.pi), "wraps", "q1 leaps by 2 pi"),
    "angle in degrees that wraps": Spoiled(
        "arm", wrapped(2, 360.0, 180 / np.pi), "wraps", "q2 leaps by 360"
    ),
    "counter of 16 bits that wraps": Spoiled(
        "ur10", wrapped(3, 65536.0, 1e4), "wraps", "q3 leaps by 65536"
    ),
    "three glitches of a position": Spoiled("scara", leapt("q", 2, 0.5), "glitches", "q2 leaps"),
    "three glitches of a torque": Spoiled("ur10", leapt("tau", 2, 900.0), "glitches", "(402, 1204"),
    "clock at half its rate": Spoiled("ur10", with_velocities(*[2.0] * 6), "clock", "--unit 't=0"),
    "velocities in deg/s": Spoiled(
        "scara", with_velocities(57.3, 57.3), "velocities", "velocities in deg/s"
    ),
    "velocities in rpm": Spoiled("arm", with_velocities(9.55, 9.55), "velocities", "in rpm"),
    "velocity of joint 2 reversed": Spoiled(
        "scara", with_velocities(1.0, -1.0), "velocities", "joint 2 has the other sign"
    ),
    "velocities exchanged": Spoiled(
        "scara", with_velocities(1.0, 1.0, order=(1, 0)), "velocities", "those of other joints"
    ),
    "standstill three quarters of the time": Spoiled(
        "scara", mostly_still, "standstill", "cut the log"
    ),
    "torques 6 rows late": Spoiled("scara", late(6), "delay", "lag by"),
    "torques 10 rows late, six joints": Spoiled("ur10", late(10), "delay", "lag by"),
    "encoder of 9 bits": Spoiled("scara", coarse(2 * np.pi / 512), "resolution", "coarse"),
    "joint 2 braked": Spoiled("scara", frozen(2), "motion", "joint 2 hardly moves"),
    "small torques of joint 2 not measured": Spoiled(
        "scara", deadened(2, 0.8), "dead zone", "joint 2 is one and the same value in"
    ),
    "position of joint 1 twice": Spoiled(
        "scara", copied(2, 1), "equal positions", "q2 is q1 in all"
    ),
    "no torque of joint 1": Spoiled("arm", dead(1), "constant torque", "joint 1 never changes"),
}
