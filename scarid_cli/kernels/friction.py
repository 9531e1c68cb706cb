"""Friction torques of joints, and which joints stick.

A row of `joints` (joints, 21) has the viscous friction forward and backward [0, 1], the Coulomb
friction forward and backward [2, 3], the Stribeck friction and its velocity [4, 5], the smoothed
Coulomb friction and its velocity [6, 7], the offset torque [8], the Coulomb friction per
transmitted torque [9], the change of all friction with time and its time constant [10, 11] and 1
if Coulomb friction holds the joint at rest [12]; friction with the square of the velocity [20]; the
rest is that of arm.py.

The friction torques of joints at rest are the solution of a linear complementarity problem with
bounds, of a symmetric positive definite matrix: it has one solution, which the pivoting method of
Murty (1974), for variables with two bounds that of Judice and Pires (1992), finds.
"""

from math import exp, sqrt, tanh

import numpy as np


def sign(x):
    """The sign of x; 0 at 0."""
    if x > 0.0:
        return 1.0
    return -1.0 if x < 0.0 else 0.0


class Friction:
    """The friction of joints (see above for the table)."""

    def __init__(self, joints):
        if joints.shape[1] != 21:
            raise ValueError("friction: numbers of columns are wrong")
        self.joints = joints

    def drift(self, i, t):
        """The factor of the friction of joint i at time t [s]."""
        if self.joints[i, 10] == 0.0:
            return 1.0
        return 1.0 + float(self.joints[i, 10]) * (1.0 - exp(-t / float(self.joints[i, 11])))

    def own(self, i, v, s, scale, tau):
        """The friction torque of joint i at velocity v, without its offset.

        s: direction of sliding, 0 for a joint that sticks. scale: see `drift`. tau: torque of the
        drive. The load is the torque that is transmitted, tau less offset and friction.
        """
        forward = s > 0.0 or (s == 0.0 and v > 0.0)
        jump = float(self.joints[i, 2]) if forward else float(self.joints[i, 3])
        if self.joints[i, 4] != 0.0:
            ratio = v / float(self.joints[i, 5])
            jump += float(self.joints[i, 4]) * exp(-ratio * ratio)
        f = (float(self.joints[i, 0]) if forward else float(self.joints[i, 1])) * v + s * jump
        if self.joints[i, 20] != 0.0:
            f += float(self.joints[i, 20]) * v * abs(v)
        if self.joints[i, 6] != 0.0:
            smooth = tanh(v / float(self.joints[i, 7]))
            f += float(self.joints[i, 6]) * smooth
            if self.joints[i, 12] == 0.0:
                s = smooth
        f *= scale
        share = scale * float(self.joints[i, 9]) * s
        if share != 0.0:
            rest = tau - float(self.joints[i, 8]) - f
            f += share * abs(rest) / (1.0 + share * sign(rest))
        return f


class System:
    """A symmetric positive definite system of equations, of which some unknowns are held at zero.

    held (unknowns): 1 for an unknown that is held.
    """

    def __init__(self, matrix, held):
        size = len(held)
        if matrix.shape[0] != size or matrix.shape[1] != size:
            raise ValueError("friction: lengths differ")
        self.size, self.matrix, self.held = size, matrix, held
        self.lower = np.zeros((size, size))

    def factor(self):
        """Compute Cholesky's factor, its diagonal inverted; 1 if the matrix has none."""
        for j in range(self.size):
            self.lower[j, j] = 1.0
            if self.held[j] == 0.0:
                d = float(self.matrix[j, j])
                for k in range(j):
                    d -= float(self.lower[j, k]) * float(self.lower[j, k])
                if not d > 1e-14 * abs(float(self.matrix[j, j])):
                    return 1
                self.lower[j, j] = 1.0 / sqrt(d)
            for i in range(j + 1, self.size):
                self.lower[i, j] = 0.0
                if self.held[i] == 0.0 and self.held[j] == 0.0:
                    d = float(self.matrix[i, j])
                    for k in range(j):
                        d -= float(self.lower[i, k]) * float(self.lower[j, k])
                    self.lower[i, j] = d * float(self.lower[j, j])
        return 0

    def substitute(self, x, row):
        """Solve the factored system: row `row` of x is the right side, and then the solution."""
        for i in range(self.size):
            d = 0.0
            if self.held[i] == 0.0:
                d = float(x[row, i])
                for k in range(i):
                    d -= float(self.lower[i, k]) * float(x[row, k])
            x[row, i] = d * float(self.lower[i, i])
        for i in range(self.size - 1, -1, -1):
            d = float(x[row, i])
            for k in range(i + 1, self.size):
                d -= float(self.lower[k, i]) * float(x[row, k])
            x[row, i] = d * float(self.lower[i, i])
        return 0


def violated(matrix, contact, x, k):
    """What contact k would do instead: 0 if it is consistent, or 1, -1, or 2 to stick."""
    if contact[1, k] == 2.0:
        if x[0, k] > contact[2, k]:
            return 1
        return -1 if x[0, k] < -float(contact[3, k]) else 0
    a = float(contact[5, k])
    for j in range(len(matrix)):
        a -= float(matrix[k, j]) * float(x[0, j])
    return 2 if a * float(contact[0, k]) < 0.0 else 0


def release(matrix, contact):
    """Find which contacts at rest stick, and in which direction the others slide.

    matrix (contacts, contacts): acceleration of each contact per force at each. contact (9,
    contacts): direction of sliding [0]; 0 for a contact that takes no part, 1 for one that slides,
    2 for one that sticks [1]; friction forward and backward at rest [2, 3]; acceleration without
    friction [5]. Rows 0 and 1 are changed. Returns the number of exchanges.
    """
    size = contact.shape[1]
    if contact.shape[0] != 9:
        raise ValueError("friction: numbers of rows are wrong")
    held, x = np.zeros(size), np.zeros((1, size))
    system = System(matrix, held)
    for exchange in range(1000):
        stuck(system, contact, held, x)
        change = 0
        for k in range(size):
            if contact[1, k] != 0.0:
                change = violated(matrix, contact, x, k)
            if change != 0:
                contact[0, k] = 0.0 if change == 2 else change
                contact[1, k] = 2.0 if change == 2 else 1.0
                break
        if change == 0:
            return exchange
    return 1000


def stuck(system, contact, held, x):
    """The friction of all contacts, if those that stick do not accelerate."""
    size = len(held)
    for k in range(size):
        held[k] = 0.0 if contact[1, k] == 2.0 else 1.0
        x[0, k] = contact[5, k]
        for j in range(size):
            if contact[1, j] == 1.0:
                x[0, k] -= float(system.matrix[k, j]) * slipping(contact, j)
    system.factor()
    system.substitute(x, 0)
    for k in range(size):
        if contact[1, k] == 1.0:
            x[0, k] = slipping(contact, k)
    return 0


def slipping(contact, k):
    """The friction of a contact at rest that begins to slide."""
    return float(contact[2, k]) if contact[0, k] > 0.0 else -float(contact[3, k])
