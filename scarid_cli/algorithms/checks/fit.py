"""The delay of the torques, how well the model explains them, and what the motion determines."""

from __future__ import annotations

from math import pi

import numpy as np

from scarid_cli.algorithms.changes.wiring import Wiring
from scarid_cli.algorithms.checks.finding import Finding, failed, joints_text, ok, warning
from scarid_cli.algorithms.checks.model import Samples, Solution, enough, solved
from scarid_cli.algorithms.checks.motion import Motion
from scarid_cli.algorithms.inference.verdict import POOR, WEAK, combination
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array
from scarid_cli.interval import plus_minus

STEPS = 6  # fits of the delay, each from the delay of the one before
NEAR = 0.75  # of a row: a remaining delay up to this is small enough
LATE = 1.5  # rows: position and torque are often read one row apart
PHASE = 0.02  # rad at the bandwidth of the motion: the share of an inertia that looks like friction
DEVIATIONS = 3.0
UNEXPLAINED = 0.5  # R2 below which the log is not of this robot


def samples_of(robot: Robot, motion: Motion) -> Samples | None:
    """The rows of a motion to fit; None if none of its segments is long enough for its cut-off."""
    parts = motion.parts()
    if not parts:
        return None
    span = sum(segment.q.shape[1] for segment in motion.segments) * motion.h
    return Samples.of(parts, span, motion.cutoff, enough(robot))


def aligned(robot: Robot, motion: Motion, wiring: Wiring) -> tuple[float, float, Samples]:
    """The delay [s] of the torques behind the motion, its error, and the samples without it.

    The motion must have samples. A delay of a quarter of the log or more is none.
    """
    first = _wired(robot, motion, wiring)
    assert first
    samples, whole = first, 0
    for _ in range(STEPS):
        rest, error = _rest(robot, samples)
        delay = whole * motion.h + rest
        step = round(rest / motion.h)
        if abs(rest) < NEAR * motion.h or not step:
            return delay, error, samples
        whole += step
        shifted = _wired(robot, motion.delayed(whole), wiring) if _possible(motion, whole) else None
        if shifted is None:
            return 0.0, np.inf, first
        samples = shifted
    return delay, error, samples


def _possible(motion: Motion, rows: int) -> bool:
    shortest = min(segment.q.shape[1] for segment in motion.segments)
    return abs(rows) < int(shortest) // 4


def _wired(robot: Robot, motion: Motion, wiring: Wiring) -> Samples | None:
    samples = samples_of(robot, motion)
    return samples.wired(wiring) if samples else None


def _rest(robot: Robot, samples: Samples) -> tuple[float, float]:
    """The delay [s] of the torques of all joints, and its standard error."""
    q, dq, ddq, tau, slope = samples.motion
    W = np.concatenate((robot.regressor(q, dq, ddq), slope.T[:, :, None]), axis=2)
    found = solved(W, tau, samples.counts)
    return -float(found.theta[-1]), float(found.scatter(len(tau))[-1])


def delay(seconds: float, error: float, motion: Motion) -> Finding:
    """The delay [s] of the torques of a motion, and its error."""
    rows = seconds / motion.h
    phase = 2.0 * pi * motion.bandwidths.max() * abs(seconds)
    how = "lag" if seconds >= 0.0 else "lead"
    known = plus_minus(1e3 * error, 1)
    figure = f"torques {how} by {1e3 * abs(seconds):.3g} {known} ms ({abs(rows):.2g} rows)"
    if abs(rows) <= LATE or abs(seconds) <= DEVIATIONS * error or phase <= PHASE:
        return ok("delay", figure)
    advice = "positions and torques are not of one instant: `scarid identify --align` fits it"
    return warning("delay", figure, advice)


def model(robot: Robot, samples: Samples) -> list[Finding]:
    """How much of the torques the model explains, and whether the motion determines it."""
    q, dq, ddq, tau, _ = samples.motion
    W = robot.regressor(q, dq, ddq)
    found = solved(W, tau, samples.counts)
    r2 = 1.0 - found.residuals
    return [_fit(robot, r2), _identifiable(robot, found)]


def _fit(robot: Robot, r2: Array) -> Finding:
    figure = f"R2 {', '.join(f'{x:.4f}' for x in r2)}"
    poor = np.flatnonzero(r2 < POOR)
    if not len(poor):
        return ok("model", figure)
    names = f"the torque of {joints_text(poor + 1)}"
    advice = f"is this {robot.short_name}, with the tool that it has? It does not explain {names}"
    advice += ", unless this hardly varies beside its noise"
    return (failed if r2.min() < UNEXPLAINED else warning)("model", figure, advice)


def _identifiable(robot: Robot, found: Solution) -> Finding:
    """The condition number of the regressor with columns of unit length."""
    size = np.sqrt(np.sum(found.stacked**2, axis=0))
    absent = [name for name, x in zip(robot.names, size, strict=True) if not x > 0.0]
    advice = "use a motion that excites it (`scarid trajgen`), or fewer parameters"
    if absent and robot.body and not any(robot.body.gravity):  # which has been told
        return ok("identifiability", f"without gravity, nothing determines {', '.join(absent)}")
    if absent:
        return failed("identifiability", f"nothing determines {', '.join(absent)}", advice)
    _, s, v = np.linalg.svd(found.stacked / size, full_matrices=False)
    condition = float(s[0] / s[-1]) if s[-1] > 0.0 else np.inf
    figure = f"scaled condition number {condition:.3g}"
    if condition <= WEAK:
        return ok("identifiability", figure)
    weak = combination(v[-1] / size, robot.names)
    return failed("identifiability", f"{figure}, least determined: {weak}", advice)
