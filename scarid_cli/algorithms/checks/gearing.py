"""The clock, gears and couplings of a log, by what explains its torques.

A clock that is wrong by a factor makes inertias too large beside the torques of gravity; the angle
of a motor turns by other sines than that of its joint; and where joints are measured from the base,
or torques are those of belts, each signal belongs to two joints. Each of these is fitted to the
log, and one that leaves far less of the torques unexplained is preferred.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass, replace
from functools import partial
from math import degrees

import numpy as np

from scarid_cli.algorithms.checks.finding import Finding, failed, joints_text
from scarid_cli.algorithms.checks.model import Fit, Samples, columns, fitted, solved
from scarid_cli.algorithms.checks.motion import Motion
from scarid_cli.algorithms.checks.scale import Scale, scale_of
from scarid_cli.algorithms.checks.search import ALIKE, FALL, Explained, searched
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.tuning.lowpassed import Segment
from scarid_cli.arrays import Array, Marks

BETTER = "the model fits far better"
FEW = 300  # samples that are fitted while factors are looked for
FACTORS: Array = np.exp2(np.arange(-8.0, 9.0))  # that are tried first
COUNTS: Array = np.exp2(np.arange(-22.0, -8.0))  # and where positions may be an encoder's counts
PRECISE = 1e-4  # of a factor, to which the best of them is refined
SLIGHT = 0.05  # of a factor: less is another error of the model
UNEXPLAINED = 0.2  # of the mean square torque of a joint that a model leaves which does not fit
ROUGH = 0.05  # the same with other gears: more is left where zeros differ as well
STEPS, STEP, SETTLED, TINY = 8, 0.5, 1e-3, 1e-5  # of zeros: how many, and their sizes [rad]
SMALL = 0.02  # rad: less is another error of the model
LEFT = 3e-4  # of the mean square torque of a joint: noise leaves as much
GEARED = 0.02  # of the mean square torque of a joint: what a wrong gear or coupling leaves of one


@dataclass(frozen=True)
class Gearing:
    """What times, positions and torques have to be multiplied by, and what is taken from them.

    `time` is the factor of times, `scales` (joints) those of positions. From the position of a
    joint that of the joint before it is taken `behind` (joints) times: 1 where it is measured from
    the base, -1 if the axes point in opposite directions. To the torque of a joint that of the
    next one is added `carried` (joints) times. `zeros` (joints) [rad] are the positions of the
    joints where the log has 0.
    """

    time: float
    scales: tuple[float, ...]
    behind: tuple[int, ...]
    carried: tuple[int, ...]
    zeros: tuple[float, ...]

    @classmethod
    def none(cls, joints: int) -> Gearing:
        return cls(1.0, (1.0,) * joints, (0,) * joints, (0,) * joints, (0.0,) * joints)

    def positions(self, q: Array) -> Array:
        """The positions (joints, samples) of the joints [rad or m]."""
        return np.asarray(self.moves(q) + np.array(self.zeros)[:, None])

    def moves(self, q: Array) -> Array:
        """The moves (joints, ...) of the joints, or derivatives of their positions."""
        scaled = (np.array(self.scales) * q.T).T
        found = scaled.copy()
        for j, times in enumerate(self.behind[1:], start=1):
            found[j] -= times * scaled[j - 1]
        return found

    def torques(self, tau: Array) -> Array:
        """The torques (joints, ...) of the joints."""
        found = tau.copy()
        for j, times in enumerate(self.carried[:-1]):
            found[j] += times * tau[j + 1]
        return found

    def seen(self, samples: Samples) -> Samples:
        """The samples as the joints themselves would have been logged."""
        q, dq, ddq, tau, slope = samples.motion
        motion = [
            self.positions(q),
            self.moves(dq) / self.time,
            self.moves(ddq) / self.time**2,
            self.torques(tau),
            self.torques(slope) / self.time,
        ]
        return replace(samples, motion=np.stack(motion))

    @property
    def unscaled(self) -> bool:
        """Whether positions are those of the log but for what another error may change."""
        return bool(np.abs(np.log(self.scales)).max() < SLIGHT)

    @property
    def same(self) -> bool:
        """Whether nothing differs but by what another error of the model may change."""
        timed = abs(np.log(self.time)) >= SLIGHT
        moved = max(map(abs, self.zeros)) >= SMALL
        return self.unscaled and not (timed or moved or any((*self.behind, *self.carried)))

    def motion(self, motion: Motion) -> Motion:
        """The motion of a log as the joints themselves would have been logged."""
        segments = tuple(
            Segment(self.positions(x.q), self.torques(x.tau), np.abs(self.moves(x.noise)))
            for x in motion.segments
        )
        return replace(
            motion,
            segments=segments,
            h=self.time * motion.h,
            bandwidths=motion.bandwidths / self.time,
            torques=motion.torques / self.time,
            cutoff=motion.cutoff / self.time,
        )

    def carrying(self) -> Iterator[Gearing]:
        """One joint more has a part of the torque of the next."""
        for j in range(len(self.scales) - 1):
            yield from (replace(self, carried=_with(self.carried, j, x)) for x in (1, -1))

    def lagging(self) -> Iterator[Gearing]:
        """One joint more is measured from the base, or all of them are."""
        joints = len(self.scales)
        for sign in (1, -1):
            for j in range(1, joints):
                yield replace(self, behind=_with(self.behind, j, sign))
            yield replace(self, behind=(0, *[sign] * (joints - 1)))


def _with(values: tuple[int, ...], place: int, value: int) -> tuple[int, ...]:
    return (*values[:place], value, *values[place + 1 :])


def geared(robot: Robot, samples: Samples, *, suspected: bool = False) -> Explained[Gearing]:
    """The clock, gears and couplings that explain the log: none, unless others are far better.

    Gears, and positions measured from the base, are looked for only where a joint is left
    unexplained as by a wrong one, or where they are `suspected`.
    """
    few = samples.spread(FEW)
    joints = len(robot.joints)

    def fit_of(case: Gearing) -> Fit:
        return fitted(robot, case.seen(few))

    def neighbours(found: Explained[Gearing]) -> list[Gearing]:
        own = [_refined(partial(_timed, found.case), fit_of), *found.case.carrying()]
        every = [j for j, joint in enumerate(robot.joints) if joint.unit == "rad"]
        own += [_zeroed(robot, found.case, few, fit_of, every)] if every else []
        if found.fit.residuals.max() < GEARED and not suspected:
            return own
        groups = [every, *([j] for j in every)] if len(every) > 1 else [every]
        factors = np.concatenate((COUNTS, FACTORS)) if suspected else FACTORS
        own += [
            _refined(partial(_scaled, found.case, group), fit_of, factors)
            for group in groups
            if group
        ]
        return [*own, *found.case.lagging()]

    none = Gearing.none(joints)
    start = Explained(none, fit_of(none))
    found = searched(start, fit_of, neighbours)
    most = UNEXPLAINED if found.case.unscaled else ROUGH
    if found.case.same or found.fit.residuals.max() > most:
        return start
    return Explained(found.case, fitted(robot, found.case.seen(samples)))


def _timed(case: Gearing, factor: float) -> Gearing:
    return replace(case, time=factor)


def _scaled(case: Gearing, joints: list[int], factor: float) -> Gearing:
    return replace(
        case, scales=tuple(factor if j in joints else x for j, x in enumerate(case.scales))
    )


def _refined(
    case: Callable[[float], Gearing], fit_of: Callable[[Gearing], Fit], factors: Array = FACTORS
) -> Gearing:
    """The case whose factor leaves least: the best of the factors, refined between those beside."""
    from scipy.optimize import minimize_scalar  # not needed where the model explains the log

    def misfit(logarithm: float) -> float:
        return fit_of(case(float(np.exp(logarithm)))).misfit

    places = np.log(factors)
    best = int(np.argmin([misfit(x) for x in places]))
    if best in (0, len(factors) - 1):  # as if there were no gravity, or nothing else
        return case(1.0)
    bounds = places[best - 1], places[best + 1]
    found = minimize_scalar(misfit, bounds=bounds, method="bounded", options={"xatol": PRECISE})
    return case(float(np.exp(found.x)))


def _zeroed(
    robot: Robot,
    case: Gearing,
    samples: Samples,
    fit_of: Callable[[Gearing], Fit],
    turning: list[int],
) -> Gearing:
    """The case with the zeros of the turning joints (from 0) that leave least.

    They are found by Gauss and Newton's steps. Zeros that are small, or that change nothing, as
    that of a last link whose first moments are estimated, stay 0.
    """
    for _ in range(STEPS):
        motion = case.seen(samples).motion
        step = _step(robot, motion, samples.counts, turning)
        case = _moved(case, {j: case.zeros[j] + x for j, x in zip(turning, step, strict=True)})
        if np.abs(step).max(initial=0.0) < SETTLED:
            break
    most = fit_of(case).misfit + np.log(ALIKE) / len(robot.joints)
    for j in sorted(turning, key=lambda j: abs(case.zeros[j])):
        without = _moved(case, {j: 0.0})
        if abs(case.zeros[j]) < SMALL or fit_of(without).misfit < most:
            case = without
    return case


def _moved(case: Gearing, zeros: dict[int, float]) -> Gearing:
    return replace(case, zeros=tuple(zeros.get(j, x) for j, x in enumerate(case.zeros)))


def _step(robot: Robot, motion: Array, counts: Marks, turning: list[int]) -> Array:
    """By how much the zeros of joints (from 0) should move [rad], at most STEP."""
    wide = columns(robot, motion)
    theta = solved(wide, motion[3], counts).theta
    before, found = wide @ theta, []
    for j in turning:
        moved = motion.copy()
        moved[0, j] += TINY
        found.append((columns(robot, moved) @ theta - before) / TINY)
    both = np.concatenate((wide, np.stack(found, axis=2)), axis=2)
    step = solved(both, motion[3], counts).theta[-len(turning) :]
    return np.clip(step, -STEP, STEP)


def better(found: Explained[Gearing], other: Fit, robot: Robot, samples: Samples) -> bool:
    """Whether it leaves far less than another explanation does, or torques in other units do."""
    if found.case.same:
        return False
    unit = fitted(robot, scale_of(robot, samples).corrected(samples))
    return bool(found.fit.misfit < min(other.misfit + np.log(FALL), unit.misfit))


def motors(gearing: Gearing, size: Scale) -> list[int]:
    """The joints (from 0) whose positions and torques are those of a motor behind one gear."""
    return [
        j
        for j in size.known
        if abs(np.log(gearing.scales[j])) >= SLIGHT
        and abs(np.log(np.abs(size.factors[j]) / gearing.scales[j])) < 2.0 * SLIGHT
    ]


def findings(gearing: Gearing, of_motors: Collection[int] = ()) -> list[Finding]:
    """What differs from the log as it is; none if nothing does.

    The signals of some joints (from 0) may be those of their motors.
    """
    return [
        *_clock(gearing),
        *_zeros(gearing),
        *_gears(gearing, of_motors),
        *_couplings(gearing),
    ]


def _clock(gearing: Gearing) -> Iterator[Finding]:
    if abs(np.log(gearing.time)) >= SLIGHT:
        time = f"{gearing.time:.4g}"
        figure = f"{BETTER} if the time is {time} times that of the log"
        advice = f"is the rate of the log right? `scarid convert --unit 't={time} s'`"
        yield failed("clock", figure, advice)


def _zeros(gearing: Gearing) -> Iterator[Finding]:
    moved = [(j, x) for j, x in enumerate(gearing.zeros, 1) if abs(x) >= SMALL]
    if moved:
        names = " and ".join(f"joint {j} at {degrees(x):.3g} degrees" for j, x in moved)
        values = ", ".join(f"{x:.3g} for joint {j}" for j, x in moved)
        advice = f"is this its zero? state it in the TOML file of the robot: zero = {values} [rad]"
        yield failed("zeros", f"{BETTER} with {names} where the log has a position of 0", advice)


def _gears(gearing: Gearing, of_motors: Collection[int]) -> Iterator[Finding]:
    scaled = [(j, x) for j, x in enumerate(gearing.scales) if abs(np.log(x)) >= SLIGHT]
    for factor, motor in dict.fromkeys((x, j in of_motors) for j, x in scaled):
        own = [j + 1 for j, x in scaled if (x, j in of_motors) == (factor, motor)]
        inverse = f" (1/{1.0 / factor:.4g})" if factor < 1.0 else ""
        names = f"the position{'s' if len(own) > 1 else ''} of {joints_text(own)}"
        figure = f"{BETTER} with {names} times {factor:.4g}{inverse}"
        units = " ".join(f"--unit 'q{j}={factor:.4g} rad'" for j in own)
        if motor:
            figure += f" and {'their torques' if len(own) > 1 else 'its torque'} divided by it"
            units += "".join(f" --unit 'tau{j}={1.0 / factor:.4g} N m'" for j in own)
            advice = (
                f"signals of motors: state gear_ratio = {1.0 / factor:.4g} in the TOML file, with "
                'positions = "motor" and torques = "motor" in [log], '
            )
        else:
            advice = (
                "the angle of a motor, a belt, another unit: state gear_ratio in the TOML file, "
            )
        yield failed("gears", figure, f"{advice}or `scarid convert {units}`")


def _couplings(gearing: Gearing) -> Iterator[Finding]:
    taken = [
        f"the position of joint {j} {'less' if x > 0 else 'plus'} that of joint {j - 1}"
        for j, x in enumerate(gearing.behind, 1)
        if x
    ] + [
        f"the torque of joint {j} {'plus' if x > 0 else 'less'} that of joint {j + 1}"
        for j, x in enumerate(gearing.carried, 1)
        if x
    ]
    if taken:
        advice = (
            "are joints measured from the base, or moved by belts? state [[coupling]] in the TOML "
            'file, with positions = "motor" or torques = "motor" in [log]'
        )
        yield failed("couplings", f"{BETTER} with {', and '.join(taken)}", advice)
