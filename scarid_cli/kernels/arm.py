"""An arm in closed loop: sampled control, Runge-Kutta steps that end where a joint stops or slides.

Within a step the directions of sliding are fixed. If a velocity changes its sign in a step, or the
torque that holds a joint at rest exceeds its friction, the time of the first such event is found,
and the step ends there.
"""

import numpy as np

from scarid_cli.kernels.control import Controller, eccentric, quantised
from scarid_cli.kernels.mechanics import Mechanics


class Arm:
    """The motion of an arm: `state` (2, positions) at the time of the mechanics, `k` (5, positions)
    accelerations of the stages of a step, and at its end."""

    def __init__(self, mechanics):
        self.mechanics = mechanics
        size = mechanics.size
        self.state, self.k = np.zeros((2, size)), np.zeros((5, size))

    def begin(self, t):
        """Compute contacts and accelerations of the state, t seconds after the tick.

        1: no inertia.
        """
        m = self.mechanics
        for i in range(m.size):
            m.motion[0, i] = self.state[0, i]
            m.motion[1, i] = self.state[1, i]
        m.evaluate(t)
        if m.touch(t) != 0:
            return 1
        for i in range(m.size):
            self.k[4, i] = m.x[0, i]
        m.events(t, 6)
        return 0

    def stage(self, t, row):
        """Compute the accelerations of a stage."""
        m = self.mechanics
        m.evaluate(t)
        m.forces(t)
        if m.solve() != 0:
            return 1
        for i in range(m.size):
            self.k[row, i] = m.x[0, i]
        return 0

    def step(self, t, d):
        """A step of d seconds; the mechanics are then at its end. 1: no inertia."""
        m = self.mechanics
        for i in range(m.size):
            q, v, a = float(self.state[0, i]), float(self.state[1, i]), float(self.k[0, i])
            m.motion[0, i] = q + 0.5 * d * v
            m.motion[1, i] = v + 0.5 * d * a
        if self.stage(t + 0.5 * d, 1) != 0:
            return 1
        for i in range(m.size):
            q, v, a = float(self.state[0, i]), float(self.state[1, i]), float(self.k[0, i])
            m.motion[0, i] = q + 0.5 * d * (v + 0.5 * d * a)
            m.motion[1, i] = v + 0.5 * d * float(self.k[1, i])
        if self.stage(t + 0.5 * d, 2) != 0:
            return 1
        for i in range(m.size):
            q, v = float(self.state[0, i]), float(self.state[1, i])
            m.motion[0, i] = q + d * (v + 0.5 * d * float(self.k[1, i]))
            m.motion[1, i] = v + d * float(self.k[2, i])
        if self.stage(t + d, 3) != 0:
            return 1
        for i in range(m.size):
            q, v = float(self.state[0, i]), float(self.state[1, i])
            b = float(self.k[1, i]) + float(self.k[2, i])
            m.motion[0, i] = q + d * (v + d / 6.0 * (float(self.k[0, i]) + b))
            m.motion[1, i] = v + d / 6.0 * (float(self.k[0, i]) + 2.0 * b + float(self.k[3, i]))
        return self.stage(t + d, 4)

    def locate(self, t, d):
        """The length of the step that ends just after the first event of a step of d seconds.

        The zero lies between two lengths. The next one is that of the secant through both, moved
        a little towards the older of them so that both come near; every third halves the interval.
        """
        m = self.mechanics
        low, high, side = 0.0, d, 1.0
        for trial in range(100):
            if high - low <= 1e-12 * d:
                break
            share = 1.0
            for k in range(m.n + m.m):
                if m.contact[7, k] < 0.0:
                    gap = max(float(m.contact[6, k]), 0.0)
                    share = min(share, gap / (gap - float(m.contact[7, k])))
            middle = low + share * (high - low) - side * 4e-13 * d
            if trial % 3 == 2 or not low < middle < high:
                middle = 0.5 * (low + high)
            if self.step(t, middle) != 0:
                return -1.0
            over = m.events(t + middle, 8)
            for k in range(m.n + m.m):
                m.contact[7 if over else 6, k] = m.contact[8, k]
            if over:
                high, side = middle, 1.0
            else:
                low, side = middle, -1.0
        if self.step(t, high) != 0:
            return -1.0
        m.events(t + high, 7)
        return high

    def advance(self, t, d):
        """Move on by d seconds from t seconds after the tick. 1: no inertia."""
        m = self.mechanics
        done = 0.0
        for attempt in range(20 + 4 * (m.n + m.m)):
            for i in range(m.size):
                self.k[0, i] = self.k[4, i]
            if self.step(t + done, d - done) != 0:
                return 1
            if not m.events(t + d, 7):
                self.accept()
                return 0
            # A joint that stops and slides without end (attempt): no further search.
            part = d - done
            if attempt < 19 + 4 * (m.n + m.m):
                part = self.locate(t + done, d - done)
            if part < 0.0:
                return 1
            self.accept()
            self.stop()
            done += part
            if self.begin(t + done) != 0:
                return 1
            if d - done <= 1e-12 * d:
                return 0
        return 0

    def accept(self):
        """Take the end of a step for the state."""
        m = self.mechanics
        for i in range(m.size):
            self.state[0, i] = m.motion[0, i]
            self.state[1, i] = m.motion[1, i]
            self.k[4, i] = m.x[0, i]
        for k in range(m.n + m.m):
            m.contact[6, k] = m.contact[7, k]
        for c in range(m.m):
            if m.contact[1, m.n + c] == 2.0:
                v = float(self.state[1, m.ends[c, 0]])
                self.state[1, m.ends[c, 1]] = m.ratio(c) * v
        return 0

    def stop(self):
        """Bring the joints to rest whose velocity has changed its sign."""
        m = self.mechanics
        for k in range(m.n + m.m):
            if m.contact[1, k] == 1.0 and m.contact[7, k] < 0.0:
                if k < m.n:
                    self.state[1, m.drive[k]] = 0.0
                else:
                    v = float(self.state[1, m.ends[k - m.n, 0]])
                    self.state[1, m.ends[k - m.n, 1]] = m.ratio(k - m.n) * v
        return 0

    def write(self, log, k, reading):
        """Log the tick: readings, commands, truth of the joints, torques, friction, motors."""
        m = self.mechanics
        for i in range(m.n):
            d = m.drive[i]
            log[k, i] = reading[i]
            log[k, m.n + i] = m.command[i]
            log[k, 2 * m.n + i] = self.state[0, i]
            log[k, 3 * m.n + i] = self.state[1, i]
            log[k, 4 * m.n + i] = self.k[4, i]
            log[k, 5 * m.n + i] = m.applied[i]
            log[k, 6 * m.n + i] = m.friction(i, 0.0)
            log[k, 7 * m.n + i] = self.state[0, d]
            log[k, 8 * m.n + i] = self.state[1, d]
        return 0

    def lost(self):
        """Whether the state has left all bounds."""
        for i in range(self.mechanics.size):
            if not (abs(self.state[0, i]) < 1e6 and abs(self.state[1, i]) < 1e6):
                return True
        return False


def run(reference, noise, log, state, lag, memory, plant, model, gains, setup, substeps):
    """Run the loop over the control ticks; return the number of ticks run before it failed.

    reference (ticks, 3 joints): positions, velocities and accelerations wanted. noise (ticks,
    joints): added to the positions that the encoders see. log (ticks, 9 joints): measured position,
    commanded torque; true position, velocity and acceleration, actual torque, friction torque, and
    position and velocity where the drive acts; at the tick and with its torque. state (2,
    positions), lag (joints), memory (3, joints): changed in place. plant: body, motors, joints,
    couplings, world (mechanics.py). model: the same of the a priori model, with its gravity. gains,
    setup: control.py. The last two of setup are the number of the first tick, and out: 1 if the
    inertia matrix is not positive definite.
    """
    mechanics = Mechanics(*plant)
    controller = Controller(gains, *model, memory, setup)
    arm = Arm(mechanics)
    n, size, h = mechanics.n, mechanics.size, float(setup[0])
    if len(noise) != len(reference) or len(log) != len(reference) or len(lag) != n:
        raise ValueError("arm: lengths differ")
    if state.shape[1] != size or memory.shape[1] != n or state.shape[0] != 2 or substeps < 1:
        raise ValueError("arm: lengths differ")
    if reference.shape[1] != 3 * n or noise.shape[1] != n or log.shape[1] != 9 * n:
        raise ValueError("arm: numbers of columns are wrong")
    reading = np.zeros(n)
    arm.state[:] = state
    mechanics.lag[:] = lag
    d = h / substeps
    setup[5] = 0.0
    for k in range(len(reference)):
        mechanics.start = (float(setup[4]) + k) * h
        for i in range(n):
            place = mechanics.drive[i] if setup[3] != 0.0 else i
            q = float(arm.state[0, place])
            q = eccentric(q, float(gains[i, 5]), float(gains[i, 6]), float(gains[i, 7]))
            reading[i] = quantised(q + float(noise[k, i]), float(gains[i, 4]))
        controller.command(reference, k, reading, mechanics.command)
        if arm.begin(0.0) != 0:
            setup[5] = 1.0
            return k
        arm.write(log, k, reading)
        for j in range(substeps):
            if arm.advance(j * d, d) != 0:
                setup[5] = 1.0
                return k
        mechanics.wait(h)
        if arm.lost():
            return k
    state[:] = arm.state
    lag[:] = mechanics.lag
    return len(reference)
