"""The body that is nearest to an estimate of ten inertial parameters, in units of its errors.

Ten numbers belong to a body if their pseudo-inertia, a matrix of four rows, is positive definite
(Wensing, Kim and Slotine 2018). The nearest ones are found by Newton's method with a barrier, the
logarithm of its determinant, whose weight vanishes (Boyd and Vandenberghe 2004, sections 9.6 and
11.3).
"""

from __future__ import annotations

import numpy as np

from scarid_cli.algorithms.robots.physical import LENGTH, pseudo_inertia, standard_of
from scarid_cli.arrays import Array

FALL, LAST = 0.1, 1e-7  # of the barrier's weight: four times the last is the error of the minimum
STEPS = 100  # of Newton's method, at most, for each weight
NEAR = 0.1  # the length of the last step for a weight, in the norm of the curvature
LEAST = 1e-3  # of the largest eigenvalue: the least one of the body to begin with
HELD = 1e-3  # standard deviations per own size, by which what is not told stays where it is
LIGHT = 0.01  # kg, the least mass of which this is said


def nearest(phi: Array, factor: Array) -> tuple[Array, float]:
    """The standard parameters (10) of the nearest body, and how far it is, in standard deviations.

    `phi` (10) is the estimate: the inertia about the origin [kg m2] (xx, xy, xz, yy, yz, zz), the
    first moments [kg m] and the mass [kg]. The information is factor' factor (rows, 10); what it
    does not tell is that of some body.
    """
    mass = max(abs(float(phi[9])), LIGHT)
    goal, units = phi / mass, factor * mass
    sizes = np.array([*np.full(6, LENGTH**2), *np.full(3, LENGTH), 1.0])
    information = units.T @ units + np.diag((HELD / sizes) ** 2)
    body = _start(goal)
    weight = max(1.0, float(np.sum((units @ (body - goal)) ** 2)))
    while True:
        for _ in range(STEPS):
            step, length = _step(body, goal, information, weight)
            body = body + step / (1.0 + length)  # stays a body, and is less far
            if length < NEAR:
                break
        if weight <= LAST:
            break
        weight = max(FALL * weight, LAST)
    return mass * body, float(np.linalg.norm(units @ (body - goal)))


def _step(body: Array, phi: Array, information: Array, weight: float) -> tuple[Array, float]:
    """Newton's step for half the squared distance over the weight with the barrier; its length."""
    inverse = np.linalg.inv(pseudo_inertia(body))
    turned = inverse @ PARTS
    slope = information @ (body - phi) / weight - np.trace(turned, axis1=1, axis2=2)
    curvature = information / weight + np.einsum("iab,jba->ij", turned, turned)
    scale = 1.0 / np.sqrt(np.diag(curvature))
    step = -scale * np.linalg.solve(curvature * np.outer(scale, scale), scale * slope)
    return step, float(np.sqrt(max(-slope @ step, 0.0)))


def _start(phi: Array) -> Array:
    """A body with the eigenvalues of the estimate, as far as they are positive."""
    values, vectors = np.linalg.eigh(pseudo_inertia(phi))
    least = LEAST * max(float(np.abs(values).max()), LEAST)
    J = (vectors * np.maximum(values, least)) @ vectors.T
    return np.asarray(standard_of(J, np.hstack))


PARTS = np.array([pseudo_inertia(one) for one in np.eye(10)])  # of the ten parameters
