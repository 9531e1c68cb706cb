"""The logger: from the signals at the ticks of the controller to the rows of the log."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import ceil
from typing import NamedTuple

import numpy as np

from scarid_cli.algorithms.sensors.clock import Clock, ClockState
from scarid_cli.algorithms.sensors.faults import Faults, FaultsState
from scarid_cli.algorithms.sensors.instants import Instants, Path
from scarid_cli.algorithms.sensors.motion import Encoder, Motion
from scarid_cli.algorithms.sensors.noise import GaussMarkov, NoiseState, Source
from scarid_cli.algorithms.sensors.signals import LoopLog, Signals, Ticks
from scarid_cli.algorithms.sensors.torque import TorqueSensor, rounded
from scarid_cli.arrays import Array


class Rows(NamedTuple):
    """Rows of the log: stated times (rows) [s], what was logged, and the truth at `t_true`.

    Signals are (joints, rows) each; times are from the first tick on.
    """

    t: Array
    logged: list[Array]  # q, tau, q_ref, dq_ref, ddq_ref
    true: list[Array]  # q, dq, ddq, tau, friction, q and dq of the motors
    t_true: Array


@dataclass(frozen=True)
class RecorderState:
    """The states of the parts, and the ticks from number `first` on that rows to come may need.

    `ticks` (signals, joints, ticks) are those of `Ticks`; `row` is the number of the next row.
    """

    clock: ClockState
    faults: FaultsState
    noise: NoiseState
    low_pass: Array | None = None
    ticks: Array | None = None
    first: int = 0
    row: int = 0


@dataclass(frozen=True)
class Recorder:
    """A logger that takes a row every `keep` ticks of a controller with this rate [Hz].

    Positions and torques come into the log on a `Path` each. `coloured` noise is added to the
    torques, which are rounded to their `torque_resolution` (joints) [N m or N]. For `held` and
    `on_motor` see `Signals`.
    """

    encoder: Encoder
    torque: TorqueSensor
    coloured: GaussMarkov
    torque_resolution: Array
    position_path: Path
    torque_path: Path
    clock: Clock
    faults: Faults
    keep: int
    control_rate: float
    held: bool = True
    on_motor: bool = False

    def init(self, seed: int) -> RecorderState:
        """The state before the first tick."""
        noise = self.coloured.init(Source.named(seed, "coloured-torque-noise"))
        return RecorderState(self.clock.init(seed), self.faults.init(seed), noise)

    def step(
        self, state: RecorderState, log: LoopLog, reference: Motion
    ) -> tuple[RecorderState, Rows]:
        """The state after these ticks, and the rows that are complete by then."""
        low_pass, *torques = self.torque.step(state.low_pass, log.command)
        noise, coloured = self.coloured.step(state.noise, log.q.shape[1])
        motion = (log.q, log.q_noise, log.q_true, log.dq_true, log.ddq_true, log.tau_true)
        robot = (log.friction_true, log.q_motor_true, log.dq_motor_true)
        ticks = np.array([*motion, *robot, *reference, *torques, log.tau_noise + coloured])
        if state.ticks is not None:
            ticks = np.concatenate((state.ticks, ticks), axis=2)
        state = replace(state, noise=noise, low_pass=low_pass, ticks=ticks)
        ahead = ceil(self._late) + 1 if self._late else 0
        return self._rows(state, ahead)

    @property
    def _late(self) -> float:
        """By how many ticks a row may be sampled after its nominal time."""
        return self.clock.late * self.control_rate

    def finish(self, state: RecorderState) -> Rows:
        """The rows that waited for later ticks; they hold the last tick."""
        return self._rows(state, 0)[1]

    def _rows(self, state: RecorderState, ahead: int) -> tuple[RecorderState, Rows]:
        """The rows of the ticks so far but for the last ones, `ahead` in number."""
        assert state.ticks is not None
        ticks, h = Ticks(*state.ticks), 1.0 / self.control_rate
        signals = Signals(ticks, state.first, h, held=self.held, on_motor=self.on_motor)
        count = max((signals.last - ahead) // self.keep + 1 - state.row, 0)
        nominal = (state.row + np.arange(count)) * self.keep
        clock, sampled, stamped = self.clock.step(state.clock, count)
        true, values = self._values(signals, nominal + sampled * self.control_rate)
        faults, values, kept = self.faults.step(state.faults, values)
        rows = Rows(
            (nominal / self.control_rate + stamped)[kept],
            np.split(values[:, kept], 5),
            [x[:, kept] for x in true],
            (nominal / self.control_rate + sampled)[kept],
        )
        return self._trimmed(
            replace(state, clock=clock, faults=faults, row=state.row + count)
        ), rows

    def _values(self, signals: Signals, at: Array) -> tuple[list[Array], Array]:
        """The truth, and the columns of the log, of rows sampled at these times, in ticks."""
        last = signals.last
        now = Instants.of(at[None], last)
        q = signals.readings(self.position_path.instants(at, last), self.encoder)
        tau = signals.torques(self.torque_path.instants(at, last), self.torque)
        columns = (q, rounded(tau, self.torque_resolution), *signals.references(now))
        return signals.truth(now), np.concatenate(columns)

    def _trimmed(self, state: RecorderState) -> RecorderState:
        """Without the ticks that no later row needs."""
        assert state.ticks is not None
        reach = max(self.position_path.reach, self.torque_path.reach) + self._late
        last = state.first + state.ticks.shape[2] - 1
        oldest = min(max(state.row * self.keep - ceil(reach) - 1, state.first), last)
        return replace(state, ticks=state.ticks[:, :, oldest - state.first :].copy(), first=oldest)
