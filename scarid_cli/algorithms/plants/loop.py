"""A simulated robot in closed loop (docs/simulator.md).

The controller is sampled and holds its command (plants/controllers.py). Between its ticks the robot
is integrated by the Runge-Kutta method of fourth order, whose steps end where a joint stops or
begins to slide.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import deepcopy
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from scarid_cli.algorithms.plants.controllers import KINDS, Law
from scarid_cli.algorithms.plants.imperfect import at_rest, carrying, imperfect
from scarid_cli.algorithms.plants.imperfections import PlantImperfections
from scarid_cli.algorithms.plants.model import DRIVE, Model, model
from scarid_cli.algorithms.processes.process import Process
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.sensors.motion import Encoder
from scarid_cli.algorithms.sensors.noise import GaussMarkov, NoiseState, Source
from scarid_cli.algorithms.sensors.signals import LoopLog
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault
from scarid_cli.kernels import arm

LARGE = 1e300


@dataclass(frozen=True)
class LoopState:
    """The state of the robot and its controller (kernels/arm.py), and the sources of noise.

    `motion` (2, positions): positions and velocities of the joints, then of motors behind flexible
    transmissions. `lag` (joints): torques behind the lag of the drives. `memory` (3, joints): last
    readings, velocity estimates and integrals of the controller. `tick`: number of the next tick.
    `sensing` has the state of the soft sensor of each joint, once it has taken a reading.
    """

    motion: Array
    lag: Array
    memory: Array
    tick: int
    position_noise: np.random.Generator
    torque_noise: np.random.Generator
    coloured: NoiseState | None = None
    sensing: Sequence[Any] | None = None


class DivergedError(ValueError):
    """The loop is unstable; `tick` is when its state left all bounds."""

    def __init__(self, tick: int) -> None:
        super().__init__("the closed loop is unstable")
        self.tick = tick


class IndefiniteError(ValueError):
    """The inertia matrix of the simulated robot is not positive definite at some posture."""


@dataclass(frozen=True)
class ClosedLoop:
    """A robot with its controller and sensors; arrays have one value per joint.

    Rates [Hz], resolution [rad or m], and noise as standard deviations [rad or m, N m or N].
    `eccentricity` has the amplitude [rad or m], turns and phase [rad] of the encoders (see
    `Encoder`), and `coloured` is noise of the positions beside the white one. `apriori` is the
    robot of the controller's model, by default the simulated one without its imperfections. The
    `sensors` of the joints, causal differentiators, give the controller its velocities (paper eq.
    29), in place of the smoothed difference of the readings.
    """

    robot: Robot
    law: Law
    encoder_resolution: Array
    position_noise: Array
    torque_noise: Array
    seed: int
    control_rate: float = 1000.0
    substeps: int = 2
    imperfections: PlantImperfections = field(default_factory=PlantImperfections)
    apriori: Robot | None = None
    eccentricity: tuple[Array, Array, Array] | None = None
    coloured: GaussMarkov | None = None
    sensors: Sequence[Process] | None = None

    def __post_init__(self) -> None:
        if not self.control_rate > 0.0 or self.substeps < 1:
            raise UsageFault("the control rate and the number of substeps must be positive")
        for name in ("encoder_resolution", "position_noise", "torque_noise"):
            if np.any(getattr(self, name) < 0.0):
                raise UsageFault(f"{name.replace('_', ' ')} must not be negative")

    @cached_property
    def plant(self) -> Model:
        """The simulated arm, without its payload."""
        step = 1.0 / (self.control_rate * self.substeps)
        return imperfect(model(self.robot), self.robot, self.imperfections, step)

    @cached_property
    def known(self) -> Model:
        """The a priori model of the controller."""
        return model(self.apriori or self.robot)

    @property
    def on_motor(self) -> bool:
        """Whether the encoders are on the motors of flexible joints."""
        return self.imperfections.encoder_side == "motor"

    def init(self, q: Array) -> LoopState:
        """The state at rest at q (joints) [rad or m], which is what the encoders see."""
        position_seed, torque_seed = np.random.SeedSequence(self.seed).spawn(2)
        # Rounded as the kernel does, or the first velocity would be that of a jump.
        reading = self.encoder.reading(q[:, None], np.zeros((len(q), 1)))[:, 0]
        source = Source.named(self.seed, "coloured-position-noise")
        positions, lag = at_rest(self.plant, q, on_motor=self.on_motor)
        return LoopState(
            np.array([positions, np.zeros_like(positions)]),
            lag,
            np.array([reading, np.zeros_like(q), np.zeros_like(q)]),
            0,
            np.random.default_rng(position_seed),
            np.random.default_rng(torque_seed),
            self.coloured.init(source) if self.coloured else None,
        )

    @property
    def encoder(self) -> Encoder:
        """The encoders of the joints."""
        none = np.zeros_like(self.encoder_resolution)
        return Encoder(self.encoder_resolution, *(self.eccentricity or (none, none, none)))

    def step(
        self, state: LoopState, q_ref: Array, dq_ref: Array, ddq_ref: Array
    ) -> tuple[LoopState, LoopLog]:
        """The state and the signals after the ticks of a reference (joints, ticks)."""
        state = deepcopy(state)
        joints, ticks = q_ref.shape
        reference = np.ascontiguousarray(np.concatenate((q_ref, dq_ref, ddq_ref)).T)
        noise = state.position_noise.standard_normal((ticks, joints)) * self.position_noise
        if self.coloured and state.coloured:
            after, coloured = self.coloured.step(state.coloured, ticks)
            state, noise = replace(state, coloured=after), noise + coloured.T
        torque_noise = state.torque_noise.standard_normal((ticks, joints)) * self.torque_noise
        log = np.empty((ticks, 9 * joints))
        begin = self._payload_tick - state.tick
        pieces = (slice(0, max(begin, 0)), slice(max(begin, 0), ticks))
        for piece, plant in zip(pieces, (self.plant, self._loaded), strict=True):
            if reference[piece].size:
                run = self._sensed if self.sensors else self._run
                state = run(state, plant, reference[piece], noise[piece], log[piece])
        signals = log.reshape(ticks, 9, joints).transpose(1, 2, 0)
        q, command, *truth = signals
        parts = (q, command + torque_noise.T, *truth, command, noise.T, torque_noise.T)
        return state, LoopLog(*(np.ascontiguousarray(signal) for signal in parts))

    @property
    def _payload_tick(self) -> int:
        payload = self.imperfections.payload
        return int(np.ceil(payload.start * self.control_rate - 1e-9)) if payload else 0

    @cached_property
    def _loaded(self) -> Model:
        payload = self.imperfections.payload
        return carrying(self.plant, payload) if payload else self.plant

    def _sensed(
        self, state: LoopState, plant: Model, reference: Array, noise: Array, log: Array
    ) -> LoopState:
        """The same tick by tick, with the velocities that the soft sensors make of the readings."""
        n = len(self.robot.joints)
        place = plant.joints[:, DRIVE].astype(int) if self.on_motor else np.arange(n)
        for k in range(len(reference)):
            tick = slice(k, k + 1)
            seen = self.encoder.reading(state.motion[0, place][:, None], noise[tick].T)
            sensing, velocities = self._sense(state, seen)
            memory = state.memory.copy()
            memory[1] = velocities
            state = replace(state, memory=memory, sensing=sensing)
            state = self._run(state, plant, reference[tick], noise[tick], log[tick])
        return state

    def _sense(self, state: LoopState, seen: Array) -> tuple[list[Any], list[float]]:
        """The states of the soft sensors and their velocities after the readings (joints, 1)."""
        assert self.sensors
        period = 1.0 / self.control_rate
        before = state.sensing or [
            sensor.init(float(x[0]), period) for sensor, x in zip(self.sensors, seen, strict=True)
        ]
        done = [s.step(b, x) for s, b, x in zip(self.sensors, before, seen, strict=True)]
        return [after for after, _ in done], [float(found[0][0]) for _, found in done]

    def _run(
        self, state: LoopState, plant: Model, reference: Array, noise: Array, log: Array
    ) -> LoopState:
        """Run the kernel over some ticks; the log is filled."""
        period = 1.0 / self.control_rate
        setup = np.array([period, self._smoothing, KINDS[self.law.kind], self.on_motor, 0, 0.0])
        setup[4] = state.tick
        motion, lag, memory = state.motion.copy(), state.lag.copy(), state.memory.copy()
        done = arm.run(
            reference,
            noise,
            log,
            motion,
            lag,
            memory,
            plant.tables,
            self.known.tables,
            self._gains,
            setup,
            self.substeps,
        )
        if setup[5] != 0.0:
            raise IndefiniteError
        if done < len(reference):
            raise DivergedError(state.tick + done)
        return replace(state, motion=motion, lag=lag, memory=memory, tick=state.tick + done)

    @property
    def _smoothing(self) -> float:
        if self.sensors:
            return -1.0
        cutoff = self.law.velocity_cutoff
        return float(np.exp(-2.0 * np.pi * cutoff / self.control_rate)) if cutoff > 0.0 else 0.0

    @property
    def _gains(self) -> Array:
        law = self.law
        limits = np.array([min(joint.torque_limit, LARGE) for joint in self.robot.joints])
        own = self.encoder
        encoder = (own.resolution, own.amplitude, own.turns, own.phase)
        return np.column_stack((law.kp, law.kd, law.ki, limits, *encoder))
