"""A simulated robot in closed loop (paper section 3.1 and eq. 29, with its sign corrected).

tau = Kp (q_ref - q) + Kd (dq_ref - dq_est) + Ki integral(q_ref - q), at the control rate. dq_est is
the backward difference of the encoder, smoothed by a low-pass. Between the ticks of the controller
the robot is integrated by the Runge-Kutta method of fourth order, and Coulomb friction sticks
(docs/theory.md, "Robot, control and regression").
"""

from __future__ import annotations

from copy import deepcopy
from dataclasses import dataclass, replace

import numpy as np

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.planar import HORIZONTAL
from scarid_cli.algorithms.sensors.motion import Encoder
from scarid_cli.algorithms.sensors.noise import GaussMarkov, NoiseState, Source
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault
from scarid_cli.kernels import plant

JOINTS = 2  # of the kernel; a single axis uses the first one
LARGE = 1e300


@dataclass(frozen=True)
class LoopState:
    """The state of the robot and its controller (of the kernel), and the sources of noise."""

    values: Array
    position_noise: np.random.Generator
    torque_noise: np.random.Generator
    coloured: NoiseState | None = None


@dataclass(frozen=True)
class LoopLog:
    """The signals at each tick of the controller: arrays (joints, ticks), in SI units.

    `q` and `tau` are measured; `q_noise` and `tau_noise` are the noise in them.
    """

    q: Array
    tau: Array
    q_true: Array
    dq_true: Array
    ddq_true: Array
    tau_true: Array
    q_noise: Array
    tau_noise: Array


class DivergedError(ValueError):
    """The loop is unstable; `tick` is when its state left all bounds."""

    def __init__(self, tick: int) -> None:
        super().__init__("the closed loop is unstable")
        self.tick = tick


@dataclass(frozen=True)
class ClosedLoop:
    """A robot with its controller and sensors; arrays have one value per joint.

    Gains [N m/rad, N m s/rad, N m/(rad s)], rates and the cut-off [Hz], resolution [rad or m], and
    noise as standard deviations [rad or m, N m or N]. `eccentricity` has the amplitude [rad or m],
    turns and phase [rad] of the encoders (see `Encoder`), `coloured` further noise of the position.
    """

    robot: Robot
    kp: Array
    kd: Array
    ki: Array
    velocity_cutoff: float
    encoder_resolution: Array
    position_noise: Array
    torque_noise: Array
    seed: int
    control_rate: float = 1000.0
    substeps: int = 4
    eccentricity: tuple[Array, Array, Array] | None = None
    coloured: GaussMarkov | None = None

    def __post_init__(self) -> None:
        if not self.control_rate > 0.0 or self.substeps < 1:
            raise UsageFault("the control rate and the number of substeps must be positive")
        for name in ("encoder_resolution", "position_noise", "torque_noise"):
            if np.any(getattr(self, name) < 0.0):
                raise UsageFault(f"{name.replace('_', ' ')} must not be negative")

    def init(self, q: Array) -> LoopState:
        """The state at rest at q (joints) [rad or m]."""
        position_seed, torque_seed = np.random.SeedSequence(self.seed).spawn(2)
        # Rounded as the kernel does, or the first velocity would be that of a jump.
        reading = padded(self.encoder.reading(q[:, None], np.zeros((len(q), 1)))[:, 0])
        source = Source.named(self.seed, "coloured-position-noise")
        return LoopState(
            np.concatenate((padded(q), np.zeros(2), reading, np.zeros(4))),
            np.random.default_rng(position_seed),
            np.random.default_rng(torque_seed),
            self.coloured.init(source) if self.coloured else None,
        )

    @property
    def encoder(self) -> Encoder:
        """The encoders of the joints."""
        none = np.zeros_like(self.encoder_resolution)
        return Encoder(self.encoder_resolution, *(self.eccentricity or (none, none, none)))

    def step(self, state: LoopState, q_ref: Array, dq_ref: Array) -> tuple[LoopState, LoopLog]:
        """The state and the signals after the ticks of a reference (joints, ticks)."""
        state = deepcopy(state)
        joints, ticks = q_ref.shape
        reference = np.zeros((ticks, 2 * JOINTS))
        reference[:, :joints] = q_ref.T
        reference[:, JOINTS : JOINTS + joints] = dq_ref.T
        noise = np.zeros((ticks, JOINTS))
        noise[:, :joints] = state.position_noise.standard_normal((ticks, joints))
        noise[:, :joints] *= self.position_noise
        if self.coloured and state.coloured:
            after, coloured = self.coloured.step(state.coloured, ticks)
            state = replace(state, coloured=after)
            noise[:, :joints] += coloured.T
        log = np.empty((ticks, 10))
        done = plant.run(
            reference,
            noise,
            log,
            state.values,
            mechanism(self.robot),
            self._control(),
            1.0 / self.control_rate,
            self.substeps,
        )
        if done < ticks:
            raise DivergedError(done)
        torque_noise = state.torque_noise.standard_normal((ticks, joints)) * self.torque_noise
        noises = np.ascontiguousarray(noise[:, :joints].T), np.ascontiguousarray(torque_noise.T)
        columns = [np.ascontiguousarray(log[:, i : i + joints].T) for i in range(0, 10, JOINTS)]
        q, tau, q_true, dq_true, ddq_true = columns
        return state, LoopLog(q, tau + torque_noise.T, q_true, dq_true, ddq_true, tau, *noises)

    def _control(self) -> Array:
        limits = [min(joint.torque_limit, LARGE) for joint in self.robot.joints]
        rows = [padded(row) for row in (self.kp, self.kd, self.ki, np.array(limits))]
        smoothing = 0.0
        if self.velocity_cutoff > 0.0:
            smoothing = np.exp(-2.0 * np.pi * self.velocity_cutoff / self.control_rate)
        encoder = self.encoder
        eccentricity = map(padded, (encoder.amplitude, encoder.turns, encoder.phase))
        return np.concatenate((*rows, padded(encoder.resolution), [smoothing], *eccentricity))


def padded(row: Array) -> Array:
    """A row (joints) with a value for each joint of the kernel."""
    return np.concatenate((row, np.zeros(JOINTS - len(row))))


def mechanism(robot: Robot) -> Array:
    """The parameters of the kernel's model: the a priori values of the robot."""
    joints = len(robot.joints)
    terms = {parameter.term.NAME for parameter in robot.parameters}
    friction = [
        robot.value(term, joint) for term in ("viscous", "coulomb", "offset") for joint in (1, 2)
    ]
    if joints == 2 and terms >= set(HORIZONTAL) and "mass" not in terms:
        inertia = [robot.value(term) for term in HORIZONTAL]
    elif joints == 1 and "mass" in terms:
        # The second joint is there for the kernel only: L1MX2 = -ZZ2 uncouples it (M12 = 0).
        inertia = [robot.value("mass", 1) + 1.0, 1.0, -1.0, 0.0]
    else:
        raise UsageFault(
            f"robot {robot.name}: only one axis (mass) and the planar arm (ZZ1R, ZZ2, L1MX2, "
            "L1MY2) can be simulated"
        )
    return np.array(inertia + friction)
