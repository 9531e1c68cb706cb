"""Conditions under which robots are simulated for the gauntlet, and their true parameters.

CONDITIONS are those of the gauntlet. UNSEEN were first simulated when the procedure was finished:
nothing in it was chosen with them.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cache, partial
from pathlib import Path

import numpy as np
from altered import Change, altered, clipped, drifted, hurried, loose, pulled, saturated
from arms import URDFS, described
from mechanics import BUILT, CHANGES, FREQUENCIES, LOADED, cubic, geared, one_flexible

from scarid_cli.algorithms.choices.registry import EXCITATIONS
from scarid_cli.algorithms.plants import building
from scarid_cli.algorithms.plants.controllers import law
from scarid_cli.algorithms.plants.imperfections import PlantImperfections
from scarid_cli.algorithms.plants.loop import ClosedLoop
from scarid_cli.algorithms.plants.model import dynamics, model
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.algorithms.trajectories.limits import Limits
from scarid_cli.arrays import Array
from scarid_cli.cli.declaring.imperfections import imperfections
from scarid_cli.io.table import Metadata, Table, concatenated
from scarid_cli.stages.resample import resample
from scarid_cli.stages.simulate import simulate
from scarid_cli.stages.trajgen import tabulate

REFERENCE = 100.0  # Hz, of the trajectories
CONTROL = 1000.0  # Hz
FLEXIBLE, CONSTANTS = "flexible joint", "motor constant"
Given = dict[str, tuple[float, ...]]


@dataclass(frozen=True)
class Condition:
    """What is not ideal: imperfections by name, in the units of the robot or of `simulate --with`.

    Those in `relative` are multiplied by the Coulomb friction of a joint, or by its torque noise.
    `altered` changes the log of a robot where no imperfection of the simulator would.
    """

    name: str
    given: Given = field(default_factory=dict)
    relative: dict[str, tuple[str, float]] = field(default_factory=dict)
    rate: float = 200.0  # Hz
    duration: float = 20.0  # s
    excitation: str = "quintic"
    speed: float = 1.0  # of the limits; those of the acceleration are multiplied by its square
    stroke: float = np.inf  # rad or m, to both sides of the home position
    altered: Change | None = None
    built: Callable[[Robot], Robot] | None = None  # the simulated robot, where it is another one
    own: Callable[[Robot], Given] | None = None  # imperfections that depend on the robot
    gain_error: float = 0.0  # of the torque constants, that is stated to the blind procedure


def _friction(name: str, imperfection: str, share: float, **more: tuple[float, ...]) -> Condition:
    given = {key.replace("_", "-"): value for key, value in more.items()}
    return Condition(name, given, {imperfection: ("coulomb", share)})


def _noise(name: str, imperfection: str, factor: float, **more: tuple[float, ...]) -> Condition:
    given = {key.replace("_", "-"): value for key, value in more.items()}
    return Condition(name, given, {imperfection: ("noise", factor)})


OFF: Given = {"torque-constant-error": (0.01,)}
CONDITIONS = [
    Condition("clean"),
    *[Condition(f"{bits} bit", {"encoder-bits": (bits,)}) for bits in (12, 14, 20)],
    *[Condition(f"{rate:g} Hz", rate=rate) for rate in (100.0, 500.0, 1000.0)],
    *[Condition(f"{time:g} s", duration=time) for time in (5.0, 120.0)],
    _noise("torque noise x4", "torque-noise", 4.0),
    *[Condition(f"torque {n} samples late", {"torque-delay": (n * 0.005,)}) for n in (1, 2, 3, 4)],
    _friction("torque offset", "torque-offset", 0.5),
    _friction("Stribeck friction", "stribeck", 0.5, stribeck_velocity=(0.1,)),
    Condition("load friction", {"load-friction": (0.02,)}),
    *[Condition(f"{FLEXIBLE} {f} Hz", {"flexibility": (f,)}) for f in (8.0, 15.0)],
    *[
        Condition(
            f"base vibrates at {f:g} Hz",
            {
                "vibration": (0.5,),
                "vibration-frequency": (f,),
                "vibration-direction": (1.0, 1.0, 1.0),
            },
        )
        for f in (6.0, 12.0, 25.0)
    ],
    *[
        _noise(f"noise over {t:g} s", "coloured-torque-noise", 1.0, torque_noise_time=(t,))
        for t in (0.5, 2.0)
    ],
    _friction("torque ripple", "ripple", 0.2, ripple_cycles=(10.0,)),
    Condition("drive low-pass 50 Hz", {"drive-bandwidth": (50.0,)}),
    Condition("logged torque behind 30 Hz", {"torque-bandwidth": (30.0,)}),
    _friction("torque outliers", "torque-outlier-size", 2.0, torque_outliers=(0.002,)),
    Condition("lost rows", {"lost-rows": (0.01,)}),
    Condition("held samples", {"repeated-rows": (0.02,)}),
    Condition("standstill", {"standstill-before": (5.0,), "standstill-after": (5.0,)}),
    Condition("cable pulls", altered=pulled),
    Condition("motor saturates", altered=saturated),
    Condition("motor saturates, stated", altered=saturated, gain_error=0.005),
    Condition("torque drifts", altered=drifted),
    Condition("torque clipped", altered=clipped),
    Condition("backlash", altered=loose),
    Condition("clock 0.1 % off", altered=hurried),
    Condition(f"{CONSTANTS} 1 % off", OFF),
    Condition(f"{CONSTANTS} 1 % off, stated", OFF, gain_error=0.01),
]


# Imperfections of moderate size, all at once.
MIXED = Condition(
    "all together",
    {
        "encoder-bits": (16,),
        "load-friction": (0.01,),
        "stribeck-velocity": (0.05,),
        "torque-bandwidth": (60.0,),
        "torque-delay": (0.004,),
        "ripple-cycles": (20.0,),
        "friction-drift": (0.05,),
        "friction-drift-time": (60.0,),
        "torque-noise-time": (0.5,),
    },
    {
        "torque-offset": ("coulomb", 0.2),
        "stribeck": ("coulomb", 0.2),
        "ripple": ("coulomb", 0.1),
        "coloured-torque-noise": ("noise", 0.5),
    },
)

NOISELESS: Given = {"encoder-bits": (0,), "position-noise": (0.0,), "torque-noise": (0.0,)}
UNSEEN = [
    Condition("asymmetric friction", {"friction-asymmetry": (0.3,)}),
    Condition("friction drifts", {"friction-drift": (0.2,), "friction-drift-time": (60.0,)}),
    Condition("eccentric encoder", {"encoder-eccentricity": (0.001,)}),
    Condition(
        "coloured position noise",
        {"coloured-position-noise": (1e-4,), "position-noise-time": (0.1,)},
    ),
    Condition("positions 5 ms late", {"position-delay": (0.005,)}),
    Condition("positions held at 50 Hz", {"position-rate": (50.0,)}),
    Condition("torques held at 50 Hz", {"torque-rate": (50.0,)}),
    Condition("logged torque behind 10 Hz", {"torque-bandwidth": (10.0,)}),
    _friction("coarse torques", "torque-resolution", 0.2),
    Condition("11 bit at 1000 Hz, slow", {"encoder-bits": (11,)}, rate=1000.0, speed=0.4),
    Condition(
        "11 bit at 1000 Hz, slow, lost rows",
        {"encoder-bits": (11,), "lost-rows": (0.01,)},
        rate=1000.0,
        speed=0.4,
    ),
    Condition("without noise", NOISELESS, rate=500.0),
    Condition("without noise, one joint at a time", NOISELESS, rate=500.0, excitation="sequential"),
    Condition("hidden jitter 1 ms", {"hidden-jitter": (0.001,)}),
    Condition("jittered stamps 1 ms", {"stamp-jitter": (0.001,)}),
    Condition(
        "position outliers", {"position-outliers": (0.001,), "position-outlier-size": (0.05,)}
    ),
    Condition(f"{FLEXIBLE} 30 Hz", {"flexibility": (30.0,)}),
    Condition(
        f"{FLEXIBLE} 15 Hz, motor encoder", {"flexibility": (15.0,), "encoder-side": ("motor",)}
    ),
    MIXED,
    Condition("slow motion", speed=0.3),
    replace(MIXED, name="slow motion, all together", speed=0.3),
    Condition("strokes of 0.15 rad", stroke=0.15),
    replace(MIXED, name="strokes of 0.15 rad, all together", stroke=0.15),
    Condition("one joint at a time", excitation="sequential"),
    replace(MIXED, name="one joint at a time, all together", excitation="sequential"),
    Condition("Fourier series", excitation="fourier"),
    replace(MIXED, name="Fourier series, all together", excitation="fourier"),
    *[Condition(name, altered=change) for name, change in CHANGES.items()],
    # A robot whose joints turn many times has no such cable.
    Condition("cubic cable", altered=partial(cubic, 0.2), stroke=1.5),
    *[Condition(name, built=build) for name, build in BUILT.items()],
    *[Condition(name, own=given) for name, given in LOADED.items()],
    *[Condition(f"{FLEXIBLE} 2, {f:g} Hz", own=partial(one_flexible, f)) for f in FREQUENCIES],
]
GEARED = {"scara2-geared": 0.05, "planar2-gravity-geared": 0.02}  # kg m2, of the second motor


@cache
def robot_named(name: str) -> Robot:
    """A robot by its name; an arm known by its URDF gets motors and friction."""
    if name in GEARED:
        return geared(load(name.removesuffix("-geared")), GEARED[name])
    if not (URDFS / f"{name}.urdf").exists():
        return load(name)
    with tempfile.TemporaryDirectory() as folder:
        return load(str(described(URDFS / f"{name}.urdf", Path(folder))))


def trajectory(robot: Robot, seed: int, condition: Condition) -> Table:
    """A random trajectory within the limits of the robot and of the condition."""
    own = Limits.of(robot.joints)
    home, speed = own.home, condition.speed
    near = Limits(home - condition.stroke, home + condition.stroke, own.dq, own.ddq)
    limits = replace(near.within(own), dq=speed * own.dq, ddq=speed**2 * own.ddq)
    rng = np.random.default_rng(seed)
    excitation = EXCITATIONS.load(condition.excitation)()
    motion = excitation.trajectory(limits, home, condition.duration, rng)
    meta = Metadata(kind="trajectory", robot=robot.name, period=1.0 / REFERENCE)
    return tabulate(motion, robot, REFERENCE, meta)


def log(
    robot: Robot, condition: Condition, seed: int, *, truth: bool = False, noise: int | None = None
) -> Table:
    """The simulated measurement, at a constant rate, with the true signals if asked for.

    `seed` is that of the motion, and of the noise if `noise` gives no other.
    """
    joints = len(robot.joints)
    sizes = {
        "coulomb": tuple(abs(robot.value("coulomb", i + 1)) for i in range(joints)),
        "noise": tuple(joint.torque_noise for joint in robot.joints),
    }
    relative = {
        name: tuple(factor * size for size in sizes[unit])
        for name, (unit, factor) in condition.relative.items()
    }
    own = condition.own(robot) if condition.own else {}
    words = (
        f"{name}={','.join(f'{x}' for x in value)}"
        for name, value in {**condition.given, **relative, **own}.items()
    )
    known = imperfections(tuple(words), {}, robot.imperfections, joints)
    loop = ClosedLoop(
        robot=condition.built(robot) if condition.built else robot,
        law=law(robot, None, None, kp=None, kd=None, ki=None),
        seed=seed if noise is None else noise,
        control_rate=CONTROL,
        substeps=2,
        **building.in_the_loop(known, robot.joints, CONTROL),
    )
    table = simulate(
        trajectory(robot, seed, condition), loop, condition.rate, truth=truth, given=known
    )
    if "lost-rows" in condition.given:
        table = resample(table, condition.rate)
    batches = list(table.batches)
    if condition.altered:
        batches = [altered(concatenated(batches), robot, condition.altered)]
    return replace(table, batches=batches)  # type: ignore[arg-type]


def truth_of(robot: Robot, condition: Condition) -> Array:
    """The true parameters, with what the condition adds to those that the robot has.

    These are the offset of the torques, that of friction which differs between the directions, the
    mean of a friction that drifts, and the inertia of a motor behind a flexible joint where that of
    the description is a part of the link's inertia.
    """
    unit, factor = condition.relative.get("torque-offset", ("coulomb", 0.0))
    factor += condition.given.get("friction-asymmetry", (0.0,))[0]
    drift = mean_drift(condition)
    truth = robot.apriori.copy()
    for i, parameter in enumerate(robot.parameters):
        if parameter.term.NAME == "offset":
            truth[i] += factor * abs(robot.value(unit, parameter.term.joints[0]))
        if parameter.term.NEVER_NEGATIVE:
            truth[i] *= 1.0 + drift
        if "flexibility" in condition.given:
            parts = dict(parameter.parts)
            truth[i] += sum(parts.get(name, 0.0) * x for name, x in added_motors(robot).items())
    return truth


def mean_drift(condition: Condition) -> float:
    """The mean over the motion of what drifting friction has grown by, relative to its value."""
    grown = condition.given.get("friction-drift", (0.0,))[0]
    time = condition.given.get("friction-drift-time", (1.0,))[0]
    begun = float(np.exp(-condition.given.get("standstill-before", (0.0,))[0] / time))
    periods = condition.duration / time
    return grown * (1.0 + begun * float(np.expm1(-periods)) / periods)


def added_motors(robot: Robot) -> dict[str, float]:
    """The inertia [kg m2] of motors that a flexible joint gets, by the name of its parameter."""
    arm = model(robot)
    own = np.diag(arm.motors)
    _, matrix = dynamics(arm, Limits.of(robot.joints).home)
    shares = np.where(own > 0.0, 0.0, PlantImperfections().motor_share * (np.diag(matrix) - own))
    return {f"Ia{i}": float(x) for i, x in enumerate(shares, start=1)}
