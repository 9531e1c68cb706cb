"""The regressor of the standard parameters of a serial chain, and its reverse pass (compiled).

`axes` (joints, 16) and `gravity` (3) are those of mechanism.Mechanism. q, dq and ddq are (joints,
samples), in rad or m, and per s and s2 (docs/theory.md, "Regressor of a chain").
"""

from __future__ import annotations

import numpy as np

from scarid_cli.arrays import Array
from scarid_cli.kernels import chain

LINK = 10  # standard parameters


def regressor(axes: Array, gravity: Array, q: Array, dq: Array, ddq: Array) -> Array:
    """The regressor (samples, joints, 10 joints), link by link in the order of rigid.SYMBOLS."""
    joints, samples = q.shape
    W = np.empty((samples * joints, LINK * joints))
    chain.regressor(*_contiguous(axes, gravity, q, dq, ddq), W, _links(joints))
    return W.reshape(samples, joints, LINK * joints)


def torques(axes: Array, gravity: Array, q: Array, dq: Array, ddq: Array, bodies: Array) -> Array:
    """The regressor times standard parameters (10 joints): torques (joints, samples)."""
    joints, samples = q.shape
    tau = np.empty((joints, samples))
    motion = _contiguous(axes, gravity, q, dq, ddq, bodies.reshape(joints, LINK))
    chain.torques(*motion, tau, _links(joints))
    return tau


def gradient(
    axes: Array, gravity: Array, q: Array, dq: Array, ddq: Array, G: Array
) -> tuple[Array, Array, Array]:
    """The derivatives of sum(G * regressor) with respect to q, dq and ddq, each (joints, samples).

    G has the shape of the regressor.
    """
    joints, samples = q.shape
    slopes = np.empty((3, joints, samples))
    rows = np.ascontiguousarray(G).reshape(samples * joints, LINK * joints)
    motion = _contiguous(axes, gravity, q, dq, ddq)
    chain.gradient(*motion, rows, *slopes, _links(joints), _links(joints))
    return slopes[0], slopes[1], slopes[2]


def _links(joints: int) -> Array:
    """Work space of the kernel."""
    return np.empty((joints + 1, 21 + 6 * joints))


def _contiguous(*arrays: Array) -> list[Array]:
    return [np.ascontiguousarray(array, dtype=np.float64) for array in arrays]
