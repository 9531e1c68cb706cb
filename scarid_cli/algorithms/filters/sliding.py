"""The base of sliding-mode differentiators, and the gains of Levant's family.

Levant, Int. J. Control 76 (2003) 924; Levant and Livne, Eur. J. Control (2020), doi
10.1016/j.ejcon.2019.08.006. See docs/theory.md, section "Sliding-mode differentiators".
"""

from __future__ import annotations

from abc import abstractmethod

import numpy as np

from scarid_cli.algorithms.processes.delays import MeasuredMethod
from scarid_cli.algorithms.processes.process import Recursion
from scarid_cli.arrays import Array

# lambda_0 ... lambda_n of the orders n = 1 to 7
LAMBDA = (
    (1.5, 1.1),
    (2.0, 2.12, 1.1),
    (3.0, 4.16, 3.06, 1.1),
    (5.0, 10.03, 9.30, 4.57, 1.1),
    (7.0, 23.72, 32.24, 20.26, 6.75, 1.1),
    (10.0, 47.69, 110.08, 101.96, 43.65, 9.91, 1.1),
    (12.0, 84.14, 281.37, 455.40, 295.74, 88.78, 14.13, 1.1),
)


class SlidingMode(MeasuredMethod):
    """A sliding-mode differentiator: a nonlinear recursion from one position to the next.

    A method states its settings, the numbers that its recursion starts with, and its law. It has
    no linearisation, since its gain is infinite at zero error, so it is matched by measured delays.
    """

    @abstractmethod
    def start(self, x: float) -> Array:
        """The numbers of the recursion before the first position x."""

    @abstractmethod
    def law(self, x: Array, v: Array, a: Array, values: Array, h: float) -> None:
        """Write the velocities and accelerations of the positions x, sampled every h [s].

        `values`, the numbers of the recursion, are changed in place.
        """

    def init(self, x: float, h: float) -> Recursion:
        return Recursion(self.start(x), h)

    def step(self, state: Recursion, x: Array) -> tuple[Recursion, tuple[Array, ...]]:
        state = state.copy()
        v, a = np.empty_like(x), np.empty_like(x)
        self.law(x, v, a, state.values, state.h)
        return state, (v, a)


def gains(order: int, bound: float) -> Array:
    """The gains lambda_i bound^((i + 1) / (order + 1)) for i = 0 ... order, of orders 1 to 7.

    bound: the largest derivative of order + 1 of the motion.
    """
    powers = np.arange(1, order + 2) / (order + 1)
    scaled: Array = np.array(LAMBDA[order - 1]) * bound**powers
    return scaled
