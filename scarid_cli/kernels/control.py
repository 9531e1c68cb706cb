"""The sampled controller of a simulated arm (paper eq. 29, and laws with an a priori model)."""

from math import floor, sin

import numpy as np

from scarid_cli.kernels.friction import Friction, sign
from scarid_cli.kernels.rigid import Chain


def quantised(x, resolution):
    """The reading of the encoder: the nearest multiple of its resolution (0: perfect)."""
    if resolution > 0.0:
        return floor(x / resolution + 0.5) * resolution
    return x


def eccentric(q, amplitude, turns, phase):
    """The position that an eccentric encoder sees: q + amplitude sin(turns q + phase)."""
    if amplitude != 0.0:
        return q + amplitude * sin(turns * q + phase)
    return q


class Controller:
    """A controller with its a priori model.

    gains (joints, 8): Kp, Kd, Ki, torque limit; resolution of the encoder, and the amplitude,
    turns and phase of its eccentricity. body, motors, joints, couplings, world: the a priori
    model, as mechanics.py has them. memory (3, joints): last readings, velocity estimates and
    integrals; changed in place. setup (6): period [s], smoothing of the velocity estimate per tick
    (0: none; below 0: `memory` has the velocities of a soft sensor), kind of control (0: PD or
    PID, 1: with gravity, 2: computed torque); the rest is that of arm.run.
    """

    def __init__(self, gains, body, motors, joints, couplings, world, memory, setup):
        n = len(joints)
        if len(gains) != n or memory.shape[1] != n:
            raise ValueError("control: lengths differ")
        if motors.shape[0] != n or motors.shape[1] != n or len(world) != 7:
            raise ValueError("control: lengths differ")
        if gains.shape[1] != 8 or body.shape[1] != 26 or joints.shape[1] != 21:
            raise ValueError("control: numbers of columns are wrong")
        if couplings.shape[1] != 6 or memory.shape[0] != 3 or len(setup) != 6:
            raise ValueError("control: sizes are wrong")
        self.n = n
        self.gains = gains
        self.motors = motors
        self.joints = joints
        self.couplings = couplings
        self.memory = memory
        self.setup = setup
        self.motion = np.zeros((2, n))
        self.wanted = np.zeros(n)
        self.bias = np.zeros(n)
        self.inertia = np.zeros((n, n))
        self.rub = Friction(joints)
        self.chain = Chain(body, world[:3], self.motion, self.bias, self.inertia)

    def command(self, reference, k, reading, tau):
        """Compute the torques of tick k from the readings of the encoders.

        reference (ticks, 3 joints): positions, velocities and accelerations wanted.
        """
        n, h, smooth = self.n, float(self.setup[0]), float(self.setup[1])
        for i in range(n):
            if smooth >= 0.0:
                w = (float(reading[i]) - float(self.memory[0, i])) / h
                self.memory[1, i] = smooth * float(self.memory[1, i]) + (1.0 - smooth) * w
            self.memory[0, i] = reading[i]
            e = float(reference[k, i]) - float(reading[i])
            rate = float(reference[k, n + i]) - float(self.memory[1, i])
            self.memory[2, i] += h * float(self.gains[i, 2]) * e
            tau[i] = float(self.gains[i, 0]) * e + float(self.gains[i, 1]) * rate
            tau[i] += self.memory[2, i]
        if self.setup[2] != 0.0:
            self.model(reference, k, tau)
        for i in range(n):
            tau[i] = min(max(float(tau[i]), -float(self.gains[i, 3])), float(self.gains[i, 3]))
        return 0

    def model(self, reference, k, tau):
        """Add gravity; or take the torques for accelerations, and compute the torques for these."""
        n = self.n
        computed = self.setup[2] == 2.0
        for i in range(n):
            self.motion[0, i] = self.memory[0, i]
            self.motion[1, i] = self.memory[1, i] if computed else 0.0
            self.wanted[i] = float(tau[i]) + float(reference[k, 2 * n + i])
        self.chain.compute()
        for i in range(n):
            if computed:
                tau[i] = 0.0
                for j in range(n):
                    m = float(self.inertia[i, j]) + float(self.motors[i, j])
                    tau[i] += m * float(self.wanted[j])
                v = float(reference[k, n + i])
                tau[i] += float(self.joints[i, 8]) + self.rub.own(i, v, sign(v), 1.0, 0.0)
            tau[i] += self.bias[i]
        if computed:
            self.coupled(reference, k, tau)
        return 0

    def coupled(self, reference, k, tau):
        """Add the friction of the couplings at the velocities wanted."""
        n = self.n
        for c in range(len(self.couplings)):
            one, two = int(self.couplings[c, 0]), int(self.couplings[c, 1])
            v, w = float(reference[k, n + one]), float(reference[k, n + two])
            slip = float(self.couplings[c, 2]) * v + float(self.couplings[c, 3]) * w
            f = float(self.couplings[c, 5]) * sign(slip)
            tau[one] += float(self.couplings[c, 4]) * w + float(self.couplings[c, 2]) * f
            tau[two] += float(self.couplings[c, 4]) * v + float(self.couplings[c, 3]) * f
        return 0
