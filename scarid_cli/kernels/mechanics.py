"""The accelerations of an arm whose joints have friction that sticks, drives and flexibility.

A joint with flexibility has a motor with a position of its own. The positions are those of the
joints, then those of these motors. Friction and torque of a joint act on its motor if it has one,
otherwise on the joint. Beyond friction.py, a row of `joints` has the number of the position on
which its drive acts [13], stiffness and damping of the transmission [14, 15], the gain of the drive
[16], the rate of its first-order lag (0: none) [17], the amplitude of the torque ripple and its
angle per position [18, 19]. A row of `couplings` (couplings, 6) has two positions [0, 1], the
velocity of the motor per velocity of each [2, 3], and its viscous and Coulomb friction [4, 5].
`world` (7): gravity, then the amplitude of the acceleration of the base, and its angular frequency.
"""

from math import exp, sin

import numpy as np

from scarid_cli.kernels.friction import Friction, System, release, sign
from scarid_cli.kernels.rigid import Chain


class Mechanics:
    """An arm at one instant.

    motion (2, positions): positions and velocities. command, lag (joints): torques of the
    controller, and of the lag at the last tick. contact (9, joints and couplings): see
    friction.release; room until a contact stops or slides, at the start of a step, at its end and
    in between [6-8].
    """

    def __init__(self, body, motors, joints, couplings, world):
        n, size, m = len(joints), len(motors), len(couplings)
        if size < n or motors.shape[1] != size:
            raise ValueError("mechanics: lengths differ")
        if body.shape[1] != 26 or joints.shape[1] != 21 or couplings.shape[1] != 6:
            raise ValueError("mechanics: numbers of columns are wrong")
        if len(world) != 7:
            raise ValueError("mechanics: sizes are wrong")
        self.n, self.size, self.m, self.start = n, size, m, 0.0
        self.drive = joints[:, 13].astype(np.intp)
        self.ends = couplings[:, :2].astype(np.intp, order="C")
        self.motors, self.joints, self.couplings, self.world = motors, joints, couplings, world
        self.motion, self.contact = np.zeros((2, size)), np.zeros((9, n + m))
        self.command, self.lag, self.applied = np.zeros(n), np.zeros(n), np.zeros(n)
        self.pull, self.bias = np.zeros(3), np.zeros(size)
        self.inertia, self.merged = np.array(motors), np.zeros((size, size))
        self.rub, self.held = Friction(joints), np.zeros(size)
        self.chain = Chain(body, self.pull, self.motion, self.bias, self.inertia)
        self.system, self.pairs = System(self.inertia, self.held), System(self.merged, self.held)
        self.x, self.rest = np.zeros((1, size)), np.zeros(size)
        self.columns, self.each = np.zeros((n + m, size)), np.zeros((n + m, n + m))

    def evaluate(self, t):
        """Compute the bias torques and the inertia matrix, t seconds after the tick."""
        wave = 0.0
        if self.world[6] != 0.0:
            wave = sin(float(self.world[6]) * (self.start + t))
        for k in range(3):
            self.pull[k] = float(self.world[k]) - float(self.world[3 + k]) * wave
        self.chain.compute()
        for i in range(self.n):
            for j in range(self.n):
                self.inertia[i, j] += self.motors[i, j]
        return 0

    def delivered(self, i, t):
        """The torque of drive i, t seconds after the tick."""
        u = float(self.joints[i, 16]) * float(self.command[i])
        if self.joints[i, 17] > 0.0:
            u += (float(self.lag[i]) - u) * exp(-float(self.joints[i, 17]) * t)
        if self.joints[i, 18] != 0.0:
            q = float(self.motion[0, self.drive[i]])
            u += float(self.joints[i, 18]) * sin(float(self.joints[i, 19]) * q)
        return u

    def forces(self, t):
        """Compute the forces on all positions, with the friction of contacts that slide."""
        for i in range(self.size):
            self.rest[i] = -float(self.bias[i]) if i < self.n else 0.0
        for i in range(self.n):
            d = self.drive[i]
            v = float(self.motion[1, d])
            s = sign(v) if self.contact[1, i] == 0.0 else float(self.contact[0, i])
            self.applied[i] = self.delivered(i, t)
            scale = self.rub.drift(i, self.start + t)
            f = self.rub.own(i, v, s, scale, float(self.applied[i]))
            self.rest[d] += float(self.applied[i]) - float(self.joints[i, 8]) - f
            if d != i:
                twist = float(self.motion[0, d]) - float(self.motion[0, i])
                f = float(self.joints[i, 14]) * twist
                f += float(self.joints[i, 15]) * (v - float(self.motion[1, i]))
                self.rest[i] += f
                self.rest[d] -= f
        for c in range(self.m):
            one, two = self.ends[c, 0], self.ends[c, 1]
            s = float(self.contact[0, self.n + c])
            if self.contact[1, self.n + c] == 0.0:
                s = sign(self.slip(self.n + c))
            viscous, f = float(self.couplings[c, 4]), s * float(self.couplings[c, 5])
            self.rest[one] -= viscous * float(self.motion[1, two]) + float(self.couplings[c, 2]) * f
            self.rest[two] -= viscous * float(self.motion[1, one]) + float(self.couplings[c, 3]) * f
        return 0

    def slip(self, k):
        """The velocity of contact k; 0 if it is that of rounding."""
        if k < self.n:
            return float(self.motion[1, self.drive[k]])
        c = k - self.n
        v = float(self.couplings[c, 2]) * float(self.motion[1, self.ends[c, 0]])
        w = float(self.couplings[c, 3]) * float(self.motion[1, self.ends[c, 1]])
        return 0.0 if abs(v + w) <= 1e-14 * abs(v) else v + w

    def solve(self):
        """Compute the accelerations of contacts that stick or slide; 1 if there are none."""
        for i in range(self.size):
            self.held[i] = 0.0
            self.x[0, i] = self.rest[i]
        for i in range(self.n):
            if self.contact[1, i] == 2.0:
                self.held[self.drive[i]] = 1.0
        if self.m > 0:
            return self.coupled()
        if self.system.factor() != 0:
            return 1
        return self.system.substitute(self.x, 0)

    def coupled(self):
        """Solve with couplings, of which those that stick let two positions move as one."""
        for i in range(self.size):
            for j in range(self.size):
                self.merged[i, j] = self.inertia[i, j]
        for c in range(self.m):
            if self.contact[1, self.n + c] == 2.0:
                self.merge(self.ends[c, 0], self.ends[c, 1], self.ratio(c))
        if self.pairs.factor() != 0:
            return 1
        self.pairs.substitute(self.x, 0)
        for c in range(self.m - 1, -1, -1):
            if self.contact[1, self.n + c] == 2.0:
                one = self.ends[c, 0]
                self.x[0, self.ends[c, 1]] = self.ratio(c) * float(self.x[0, one])
        return 0

    def ratio(self, c):
        """The velocity of the second position of a coupling that sticks, per that of the first."""
        return -float(self.couplings[c, 2]) / float(self.couplings[c, 3])

    def merge(self, one, two, ratio):
        """Let position two move by `ratio` times position one."""
        if self.held[one] != 0.0 or self.held[two] != 0.0:
            self.held[one] = 1.0
        else:
            for j in range(self.size):
                self.merged[one, j] += ratio * float(self.merged[two, j])
            for j in range(self.size):
                self.merged[j, one] += ratio * float(self.merged[j, two])
            self.x[0, one] += ratio * float(self.x[0, two])
        self.held[two] = 1.0
        return 0

    def holding(self, i):
        """The friction torque that holds joint i."""
        d = self.drive[i]
        f = float(self.rest[d])
        for j in range(self.size):
            f -= float(self.inertia[d, j]) * float(self.x[0, j])
        return f

    def friction(self, i, t):
        """The friction torque of joint i at this instant, its offset included."""
        if self.contact[1, i] == 2.0:
            return float(self.joints[i, 8]) + self.holding(i)
        v = float(self.motion[1, self.drive[i]])
        s = sign(v) if self.contact[1, i] == 0.0 else float(self.contact[0, i])
        scale = self.rub.drift(i, self.start + t)
        f = self.rub.own(i, v, s, scale, float(self.applied[i]))
        return float(self.joints[i, 8]) + f

    def wait(self, h):
        """Let the lags of the drives go on for h seconds after the tick."""
        for i in range(self.n):
            u = float(self.joints[i, 16]) * float(self.command[i])
            rate = float(self.joints[i, 17])
            self.lag[i] = u + (float(self.lag[i]) - u) * exp(-rate * h) if rate > 0.0 else u
        return 0

    def bounds(self, t):
        """Compute the friction at rest of all contacts that stick."""
        for k in range(self.n + self.m):
            if self.contact[1, k] == 2.0 and k < self.n:
                scale = self.rub.drift(k, self.start + t)
                u = float(self.applied[k])
                self.contact[2, k] = self.rub.own(k, 0.0, 1.0, scale, u)
                self.contact[3, k] = -self.rub.own(k, 0.0, -1.0, scale, u)
            elif k >= self.n:
                self.contact[2, k] = self.couplings[k - self.n, 5]
                self.contact[3, k] = self.couplings[k - self.n, 5]
        return 0

    def touch(self, t):
        """Find which contacts stick, which slide and where to; compute the accelerations."""
        still = False
        for k in range(self.n + self.m):
            sticks = self.joints[k, 12] if k < self.n else self.couplings[k - self.n, 5]
            v = self.slip(k)
            self.contact[0, k] = sign(v)
            self.contact[1, k] = 0.0 if not sticks > 0.0 else (2.0 if v == 0.0 else 1.0)
            still = still or self.contact[1, k] == 2.0
        self.forces(t)
        if self.solve() != 0:
            return 1
        if not still:
            return 0
        self.bounds(t)
        if self.consistent():
            return 0
        if self.free() != 0:
            return 1
        self.forces(t)
        return self.solve()

    def consistent(self):
        """Whether every contact at rest can be held; never known where a coupling is at rest."""
        for k in range(self.n + self.m):
            if self.contact[1, k] == 2.0:
                if k >= self.n:
                    return False
                f = self.holding(k)
                if f > self.contact[2, k] or f < -float(self.contact[3, k]):
                    return False
        return True

    def free(self):
        """Let those contacts at rest slide that cannot be held."""
        total = self.n + self.m
        for i in range(self.size):
            self.held[i] = 0.0
            self.x[0, i] = self.rest[i]
        if self.system.factor() != 0:
            return 1
        self.system.substitute(self.x, 0)
        for k in range(total):
            self.push(k)
            self.contact[5, k] = self.along(k, self.x, 0)
            if self.contact[1, k] == 1.0:
                self.contact[1, k] = 0.0
        for k in range(total):
            for j in range(total):
                self.each[k, j] = self.along(k, self.columns, j)
            if self.m > 0:  # two joints and their coupling hold each other: the force is not unique
                self.each[k, k] *= 1.0 + 1e-9
        release(self.each, self.contact)
        for k in range(total):
            if self.contact[1, k] == 0.0 and self.contact[0, k] != 0.0 and self.sharp(k):
                self.contact[1, k] = 1.0
        return 0

    def push(self, k):
        """Compute the accelerations for a unit of force at contact k."""
        for j in range(self.size):
            self.columns[k, j] = 0.0
        if k < self.n:
            self.columns[k, self.drive[k]] = 1.0
        else:
            self.columns[k, self.ends[k - self.n, 0]] = self.couplings[k - self.n, 2]
            self.columns[k, self.ends[k - self.n, 1]] = self.couplings[k - self.n, 3]
        return self.system.substitute(self.columns, k)

    def sharp(self, k):
        """Whether contact k has friction that sticks."""
        return (self.joints[k, 12] if k < self.n else self.couplings[k - self.n, 5]) > 0.0

    def along(self, k, x, row):
        """Row `row` of x in the direction of contact k."""
        if k < self.n:
            return float(x[row, self.drive[k]])
        c = k - self.n
        v = float(self.couplings[c, 2]) * float(x[row, self.ends[c, 0]])
        return v + float(self.couplings[c, 3]) * float(x[row, self.ends[c, 1]])

    def events(self, t, row):
        """Compute the room of each contact until it stops or slides; whether one has none."""
        self.bounds(t)
        over, paired = False, False
        for c in range(self.m):
            paired = paired or self.contact[1, self.n + c] == 2.0
        for k in range(self.n + self.m):
            gap = 1e300
            if self.contact[1, k] == 1.0:
                gap = self.slip(k) * float(self.contact[0, k])
            elif self.contact[1, k] == 2.0 and not paired:
                f = self.holding(k)
                gap = min(float(self.contact[2, k]) - f, float(self.contact[3, k]) + f)
            self.contact[row, k] = gap
            over = over or gap < 0.0
        return over
