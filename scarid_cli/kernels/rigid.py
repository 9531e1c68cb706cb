"""Inverse dynamics of a serial chain: bias torques and inertia matrix.

The bias torques are those of the recursive Newton-Euler method without accelerations (Luh, Walker
and Paul 1980), the inertia matrix is that of composite rigid bodies (Walker and Orin 1982). All
vectors are in the frame of their link, whose z axis is the axis of its joint.

A row of `body` (links, 26) has the rotation from the frame of the joint to the one before it, at
q = 0 [0-8]; its origin there [9-11]; 1 for a prismatic joint [12]; the standard parameters of the
link [13-22]: Ixx, Ixy, Ixz, Iyy, Iyz, Izz, mx, my, mz, m; the axis that moves the joint [23], the
ratio of their motions [24], and the position of the joint where the axis is at 0 [25]. A joint that
follows an axis adds to its torque and to its inertia. A row of `link` (links, 37) has the rotation
[0-8] and the origin [9-11] of the frame at q, angular velocity [12-14], angular and linear
acceleration [15-20], force and moment [21-26], and the parameters of this and all later links
[27-36].
"""

from math import cos, sin

import numpy as np


class Chain:
    """A serial chain at one instant.

    body (links, 26): see above. motion (2, axes or more): positions and velocities. pull (3):
    gravity less the acceleration of the base, in the frame of the base [m/s2]. bias (axes or more):
    torques of gravity, centrifugal and Coriolis forces. inertia: as many rows and columns.
    """

    def __init__(self, body, pull, motion, bias, inertia):
        n, size = len(body), motion.shape[1]
        if len(bias) != size or inertia.shape[0] != size or inertia.shape[1] != size:
            raise ValueError("rigid: lengths differ")
        if body.shape[1] != 26 or len(pull) != 3 or motion.shape[0] != 2:
            raise ValueError("rigid: numbers of columns are wrong")
        self.n, self.body, self.pull, self.motion = n, body, pull, motion
        self.bias, self.inertia, self.link = bias, inertia, np.zeros((n, 37))
        self.axis, self.axes = np.asarray(body)[:, 23].astype(np.intp), 0
        for i in range(n):
            if not 0 <= self.axis[i] < size:
                raise ValueError("rigid: no such axis")
            self.axes = max(self.axes, self.axis[i] + 1)

    def compute(self):
        """Compute the bias torques and the inertia matrix of the axes."""
        for i in range(self.axes):
            self.bias[i] = 0.0
            for k in range(self.axes):
                self.inertia[i, k] = 0.0
        for i in range(self.n):
            self.place(i)
            self.outward(i)
            self.load(i)
        for i in range(self.n - 1, -1, -1):
            torque = float(self.link[i, 26] if self.body[i, 12] == 0.0 else self.link[i, 23])
            self.bias[self.axis[i]] += float(self.body[i, 24]) * torque
            self.column(i)
            if i > 0:
                self.inward(i)
                self.combine(i)
        return 0

    def place(self, i):
        """Where the frame of joint i is in the frame before it."""
        q = float(self.body[i, 24]) * float(self.motion[0, self.axis[i]]) + float(self.body[i, 25])
        c, s = 1.0, 0.0
        if self.body[i, 12] == 0.0:
            c, s = cos(q), sin(q)
        for k in range(3):
            x, y = float(self.body[i, 3 * k]), float(self.body[i, 3 * k + 1])
            self.link[i, 3 * k] = c * x + s * y
            self.link[i, 3 * k + 1] = c * y - s * x
            self.link[i, 3 * k + 2] = self.body[i, 3 * k + 2]
            self.link[i, 9 + k] = self.body[i, 9 + k]
            if self.body[i, 12] != 0.0:
                self.link[i, 9 + k] += self.body[i, 3 * k + 2] * q
        return 0

    def row(self, i, k):
        """The vector from column k on of the row of link i."""
        return float(self.link[i, k]), float(self.link[i, k + 1]), float(self.link[i, k + 2])

    def turned(self, i, x, y, z):
        """A vector of the frame before joint i, in the frame of joint i."""
        return (
            float(self.link[i, 0]) * x + float(self.link[i, 3]) * y + float(self.link[i, 6]) * z,
            float(self.link[i, 1]) * x + float(self.link[i, 4]) * y + float(self.link[i, 7]) * z,
            float(self.link[i, 2]) * x + float(self.link[i, 5]) * y + float(self.link[i, 8]) * z,
        )

    def back(self, i, x, y, z):
        """A vector of the frame of joint i, in the frame before it."""
        return (
            float(self.link[i, 0]) * x + float(self.link[i, 1]) * y + float(self.link[i, 2]) * z,
            float(self.link[i, 3]) * x + float(self.link[i, 4]) * y + float(self.link[i, 5]) * z,
            float(self.link[i, 6]) * x + float(self.link[i, 7]) * y + float(self.link[i, 8]) * z,
        )

    def outward(self, i):
        """The velocity and acceleration of link i, without accelerations of the joints."""
        v = float(self.body[i, 24]) * float(self.motion[1, self.axis[i]])
        px, py, pz = self.row(i, 9)
        wx, wy, wz, bx, by, bz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        ax, ay, az = -float(self.pull[0]), -float(self.pull[1]), -float(self.pull[2])
        if i > 0:
            wx, wy, wz = self.row(i - 1, 12)
            bx, by, bz = self.row(i - 1, 15)
            ux, uy, uz = wy * pz - wz * py, wz * px - wx * pz, wx * py - wy * px
            ax = float(self.link[i - 1, 18]) + by * pz - bz * py + wy * uz - wz * uy
            ay = float(self.link[i - 1, 19]) + bz * px - bx * pz + wz * ux - wx * uz
            az = float(self.link[i - 1, 20]) + bx * py - by * px + wx * uy - wy * ux
            wx, wy, wz = self.turned(i, wx, wy, wz)
            bx, by, bz = self.turned(i, bx, by, bz)
        ax, ay, az = self.turned(i, ax, ay, az)
        if self.body[i, 12] == 0.0:
            bx += wy * v
            by -= wx * v
            wz += v
        else:
            ax += 2.0 * wy * v
            ay -= 2.0 * wx * v
        self.link[i, 12], self.link[i, 13], self.link[i, 14] = wx, wy, wz
        self.link[i, 15], self.link[i, 16], self.link[i, 17] = bx, by, bz
        self.link[i, 18], self.link[i, 19], self.link[i, 20] = ax, ay, az
        return 0

    def load(self, i):
        """The force and the moment that this motion of link i takes; its parameters."""
        for k in range(10):
            self.link[i, 27 + k] = self.body[i, 13 + k]
        wx, wy, wz = self.row(i, 12)
        bx, by, bz = self.row(i, 15)
        ax, ay, az = self.row(i, 18)
        xx, xy, xz = float(self.body[i, 13]), float(self.body[i, 14]), float(self.body[i, 15])
        yy, yz, zz = float(self.body[i, 16]), float(self.body[i, 17]), float(self.body[i, 18])
        cx, cy, cz = float(self.body[i, 19]), float(self.body[i, 20]), float(self.body[i, 21])
        m = float(self.body[i, 22])
        ux, uy, uz = wy * cz - wz * cy, wz * cx - wx * cz, wx * cy - wy * cx
        self.link[i, 21] = m * ax + by * cz - bz * cy + wy * uz - wz * uy
        self.link[i, 22] = m * ay + bz * cx - bx * cz + wz * ux - wx * uz
        self.link[i, 23] = m * az + bx * cy - by * cx + wx * uy - wy * ux
        hx = xx * wx + xy * wy + xz * wz
        hy = xy * wx + yy * wy + yz * wz
        hz = xz * wx + yz * wy + zz * wz
        self.link[i, 24] = xx * bx + xy * by + xz * bz + wy * hz - wz * hy + cy * az - cz * ay
        self.link[i, 25] = xy * bx + yy * by + yz * bz + wz * hx - wx * hz + cz * ax - cx * az
        self.link[i, 26] = xz * bx + yz * by + zz * bz + wx * hy - wy * hx + cx * ay - cy * ax
        return 0

    def inward(self, i):
        """Add the force and the moment of link i to those of the link before it."""
        px, py, pz = self.row(i, 9)
        x, y, z = self.row(i, 21)
        x, y, z = self.back(i, x, y, z)
        mx, my, mz = self.row(i, 24)
        mx, my, mz = self.back(i, mx, my, mz)
        self.link[i - 1, 21] += x
        self.link[i - 1, 22] += y
        self.link[i - 1, 23] += z
        self.link[i - 1, 24] += mx + py * z - pz * y
        self.link[i - 1, 25] += my + pz * x - px * z
        self.link[i - 1, 26] += mz + px * y - py * x
        return 0

    def combine(self, i):
        """Add the parameters of the links from i on to those of the link before."""
        px, py, pz = self.row(i, 9)
        m = float(self.link[i, 36])
        cx, cy, cz = self.row(i, 33)
        cx, cy, cz = self.back(i, cx, cy, cz)
        # The columns of R I, then of R I R'.
        ux, uy, uz = self.row(i, 27)
        ux, uy, uz = self.back(i, ux, uy, uz)
        xy, yy, yz = float(self.link[i, 28]), float(self.link[i, 30]), float(self.link[i, 31])
        xz, zz = float(self.link[i, 29]), float(self.link[i, 32])
        vx, vy, vz = self.back(i, xy, yy, yz)
        wx, wy, wz = self.back(i, xz, yz, zz)
        xx, xy, xz = self.back(i, ux, vx, wx)
        _, yy, yz = self.back(i, uy, vy, wy)
        _, _, zz = self.back(i, uz, vz, wz)
        sx, sy, sz = 2.0 * cx + m * px, 2.0 * cy + m * py, 2.0 * cz + m * pz
        self.link[i - 1, 27] += xx + py * sy + pz * sz
        self.link[i - 1, 28] += xy - cx * py - cy * px - m * px * py
        self.link[i - 1, 29] += xz - cx * pz - cz * px - m * px * pz
        self.link[i - 1, 30] += yy + px * sx + pz * sz
        self.link[i - 1, 31] += yz - cy * pz - cz * py - m * py * pz
        self.link[i - 1, 32] += zz + px * sx + py * sy
        self.link[i - 1, 33] += cx + m * px
        self.link[i - 1, 34] += cy + m * py
        self.link[i - 1, 35] += cz + m * pz
        self.link[i - 1, 36] += m
        return 0

    def column(self, i):
        """What joint i adds to the inertia matrix, with itself and with the joints before it."""
        x, y, z = 0.0, 0.0, float(self.link[i, 36])
        mx, my, mz = float(self.link[i, 34]), -float(self.link[i, 33]), 0.0
        if self.body[i, 12] == 0.0:
            x, y, z = -float(self.link[i, 34]), float(self.link[i, 33]), 0.0
            mx, my, mz = float(self.link[i, 29]), float(self.link[i, 31]), float(self.link[i, 32])
        self.add(i, i, mz if self.body[i, 12] == 0.0 else z)
        for k in range(i, 0, -1):
            px, py, pz = self.row(k, 9)
            x, y, z = self.back(k, x, y, z)
            mx, my, mz = self.back(k, mx, my, mz)
            mx += py * z - pz * y
            my += pz * x - px * z
            mz += px * y - py * x
            self.add(i, k - 1, mz if self.body[k - 1, 12] == 0.0 else z)
            self.add(k - 1, i, mz if self.body[k - 1, 12] == 0.0 else z)
        return 0

    def add(self, i, k, entry):
        """Add an entry of the inertia matrix of all joints to that of the axes."""
        entry *= float(self.body[i, 24]) * float(self.body[k, 24])
        self.inertia[self.axis[i], self.axis[k]] += entry
        return 0


def dynamics(body, pull, motion, bias, inertia):
    """Compute the bias torques and the inertia matrix of a chain (see Chain)."""
    return Chain(body, pull, motion, bias, inertia).compute()
