"""Phase matching of methods that are nearly linear: by their linearisation."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import Any

from scarid_cli.algorithms.processes.method import MatchedForm, Matching, Method
from scarid_cli.algorithms.processes.process import Causal, Process, Recursion
from scarid_cli.arrays import Array


class LinearisedMethod(Causal, Method):
    """A nonlinear method that is a linear one as long as its signals stay small."""

    MATCHING = Matching.LINEARISED

    @abstractmethod
    def linearisation(self) -> Process:
        """The low-pass of the linearised method, in the Euler steps of the method.

        Its output is taken at the sample where its central differences are the matched velocity
        and acceleration, exactly while the method is linear.
        """

    @abstractmethod
    def paired(self, state: Recursion, x: Array) -> tuple[Recursion, Array, Array]:
        """The state after the positions x, with velocities and accelerations of one filter.

        Each velocity is the one before the recursion adds the acceleration over the next period.
        """

    def matched(self) -> Linearised:
        return Linearised(self)


@dataclass(frozen=True)
class LinearisedState:
    """The state of the method, and that of the linearisation which the position passes."""

    own: Recursion
    position: Any


@dataclass(frozen=True)
class Linearised(Causal, MatchedForm):
    """The matched form: the method's acceleration, and the velocity brought to its instant."""

    method: LinearisedMethod

    @property
    def torque_filter(self) -> Process:
        return self.method.linearisation()

    def init(self, x: float, h: float) -> LinearisedState:
        return LinearisedState(self.method.init(x, h), self.torque_filter.init(x, h))

    def step(self, state: LinearisedState, x: Array) -> tuple[LinearisedState, tuple[Array, ...]]:
        own, v, a = self.method.paired(state.own, x)
        position, (q,) = self.torque_filter.step(state.position, x)
        return LinearisedState(own, position), (q, v + 0.5 * own.h * a, a)
