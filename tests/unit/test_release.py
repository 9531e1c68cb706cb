"""Which contacts at rest stick and which slide: the pivoting method against all combinations."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from scarid_cli.arrays import Array
from scarid_cli.kernels import friction


def consistent(matrix: Array, forward: Array, backward: Array, free: Array) -> list[Array]:
    """The directions of all consistent combinations of sticking and sliding; there are 3^n."""
    found = []
    for way in itertools.product((-1.0, 0.0, 1.0), repeat=len(free)):
        s = np.array(way)
        force = np.where(s > 0.0, forward, -backward) * (s != 0.0)
        stuck = np.flatnonzero(s == 0.0)
        if len(stuck):
            rest = (free - matrix @ force)[stuck]
            force[stuck] = np.linalg.solve(matrix[np.ix_(stuck, stuck)], rest)
        a = free - matrix @ force
        held = (force <= forward) & (force >= -backward)
        if np.all(np.where(s == 0.0, held, a * s > 0.0)):
            found.append(s)
    return found


@pytest.mark.parametrize("contacts", [1, 2, 3, 4, 5])
def test_contacts_are_released_as_the_one_consistent_combination(contacts: int) -> None:
    rng = np.random.default_rng(contacts)
    most = 0
    for _ in range(60):
        root = rng.standard_normal((contacts, contacts))
        matrix = root @ root.T + 0.05 * np.eye(contacts)
        forward, backward = rng.uniform(0.1, 1.5, (2, contacts))
        free = matrix @ rng.uniform(-3.0, 3.0, contacts)
        (expected,) = consistent(matrix, forward, backward, free)
        contact = np.zeros((9, contacts))
        contact[1], contact[2], contact[3], contact[5] = 2.0, forward, backward, free
        most = max(most, friction.release(matrix, contact))
        np.testing.assert_array_equal(contact[0], expected)
        np.testing.assert_array_equal(contact[1] == 2.0, expected == 0.0)
    assert most <= 4 * contacts  # of 3^contacts
