"""A robot as the commands see it: joints, parameters with a priori values, regressor."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, cast

import numpy as np

from scarid_cli.algorithms.robots.joints import Joint
from scarid_cli.algorithms.robots.logs import LogFormat
from scarid_cli.algorithms.robots.terms import Coulomb, JointMotion, StandardTerm, Stribeck, Term
from scarid_cli.arrays import Array

if TYPE_CHECKING:
    from scarid_cli.algorithms.robots.coupled import CoupledTerm
    from scarid_cli.algorithms.robots.rigid import Body

BLOCK = 512  # samples whose columns are written together, so that they stay in the cache


@dataclass(frozen=True)
class Parameter:
    """A parameter with its a priori value, and the term of the torques that it multiplies.

    A base parameter is a combination: `parts` are the parameters it stands for, with their factors.
    """

    name: str
    unit: str
    apriori: float
    term: Term
    parts: tuple[tuple[str, float], ...] = ()

    @property
    def stands_for(self) -> str:
        """The combination that a base parameter stands for, written out; empty if it is alone."""
        rest = "".join(
            f" {'-' if x < 0.0 else '+'} {abs(x):.6g} {name}"
            for name, x in self.parts
            if name != self.name
        )
        return f"{self.name}{rest}" if rest else ""


@dataclass(frozen=True)
class Control:
    """The controller of the simulated robot (plants/controllers.py has the laws).

    Gains per joint [N m/rad, N m s/rad, N m/(rad s)], or with N and m for prismatic ones; the
    cut-off [Hz] of the low-pass of the differentiated encoder. Without gains they are found from
    the bandwidth [Hz], 0 for the default one.
    """

    kp: tuple[float, ...] = ()
    kd: tuple[float, ...] = ()
    ki: tuple[float, ...] = ()
    velocity_cutoff: float = 0.0
    kind: str = "pid"
    bandwidth: float = 0.0


@dataclass(frozen=True)
class Robot:
    """A robot; its torques are linear in its parameters, tau = W(q, dq, ddq) theta (eq. 3)."""

    name: str
    title: str
    joints: tuple[Joint, ...]
    parameters: tuple[Parameter, ...]
    control: Control | None
    body: Body | None = None
    log: LogFormat | None = None
    imperfections: dict[str, tuple[float, ...]] = field(default_factory=dict)  # see simulate

    @property
    def short_name(self) -> str:
        """The name, without the folder of a description in a file."""
        return self.name.rpartition("/")[2]

    @property
    def names(self) -> list[str]:
        return [parameter.name for parameter in self.parameters]

    @property
    def apriori(self) -> Array:
        """A priori values (parameters), in SI units."""
        return np.array([parameter.apriori for parameter in self.parameters])

    @property
    def motors(self) -> tuple[CoupledTerm, ...]:
        """The Coulomb friction of motors that turn with two joints."""
        terms = (parameter.term for parameter in self.parameters)
        shared = (term for term in terms if term.JUMPS and len(term.joints) > 1)
        return cast("tuple[CoupledTerm, ...]", tuple(shared))

    def value(self, term: str, joint: int | None = None) -> float:
        """The a priori value of a term, of a joint (from 1); 0 if there is no such parameter."""
        found = (
            p.apriori
            for p in self.parameters
            if term == p.term.NAME and (joint is None or joint in p.term.joints)
        )
        return next(found, 0.0)

    def smoothed(self, velocity: float) -> Robot:
        """The robot with tanh(dq / velocity) for the sign in Coulomb friction [rad/s or m/s]."""
        parameters = (
            replace(p, term=replace(p.term, velocity=velocity))
            if isinstance(p.term, Coulomb)
            else p
            for p in self.parameters
        )
        return replace(self, parameters=tuple(parameters))

    def with_stribeck(self, velocities: dict[int, float]) -> Robot:
        """The robot with Stribeck friction on joints (from 1), each with its velocity."""
        added = (
            Parameter(
                Stribeck.SYMBOL.format(i=i),
                self.joints[i - 1].torque_unit,
                0.0,
                Stribeck(i, velocity),
            )
            for i, velocity in velocities.items()
        )
        return replace(self, parameters=(*self.parameters, *added))

    def with_values(self, values: dict[str, float]) -> Robot:
        """The robot with other a priori values of some parameters, by name."""
        parameters = (replace(p, apriori=values.get(p.name, p.apriori)) for p in self.parameters)
        return replace(self, parameters=tuple(parameters))

    def regressor(self, q: Array, dq: Array, ddq: Array) -> Array:
        """The regressor W (samples, joints, parameters) of tau = W theta (paper eq. 3 and 25).

        q, dq and ddq are (joints, samples), in rad or m, and per s and s2.
        """
        joints, samples = q.shape
        W = np.zeros((samples, joints, len(self.parameters)))
        for start in range(0, samples, BLOCK):
            part = slice(start, start + BLOCK)
            self._fill(W[part], JointMotion(q[:, part], dq[:, part], ddq[:, part]))
        return W

    def _fill(self, W: Array, motion: JointMotion) -> None:
        """Write the columns of all parameters to W, which is zero."""
        rigid = {}
        for index, parameter in enumerate(self.parameters):
            if isinstance(parameter.term, StandardTerm):
                rigid[index] = parameter.term.place
                continue
            for joint, values in parameter.term.column(motion).items():
                W[:, joint, index] = values
        if self.body:
            columns = self.body.columns(motion.q, motion.dq, motion.ddq)
            W[:, :, list(rigid)] = columns.take(list(rigid.values()), axis=2)

    def partial_torques(self, motion: Array, kept: list[int], theta: Array) -> Array:
        """The torques (samples, joints) of the parameters `kept` alone, whose values are theta.

        motion (3, joints, samples): positions, velocities and accelerations.
        """
        parameters = tuple(self.parameters[i] for i in kept)
        places = [p.term.place for p in parameters if isinstance(p.term, StandardTerm)]
        if self.body and len(places) == len(parameters):
            return np.ascontiguousarray(self.body.torques(motion, places, theta).T)
        return replace(self, parameters=parameters).regressor(*motion) @ theta

    def torques(self, W: Array, theta: Array) -> Array:
        """The torques W theta (joints, samples) [N m or N].

        They are summed parameter by parameter: a matrix product would round differently with the
        number of rows in a batch.
        """
        total = W[:, :, 0] * theta[0]
        for index in range(1, len(theta)):
            total += W[:, :, index] * theta[index]
        return np.ascontiguousarray(total.T)
