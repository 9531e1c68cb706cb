"""Pick-ups and put-downs, from sums whose noise and payloads are known."""

from __future__ import annotations

import numpy as np
from conftest import seeds
from hypothesis import given, settings
from hypothesis import strategies as st

from scarid_cli.algorithms.changes.carried import BLOCK, SIZES, Carrying, Piece, Sums

ROWS = 50  # of a block
HEAVY = np.array([0.01, 0.0, 0.0, 0.01, 0.0, 0.01, 0.1, -0.05, 0.2, 2.0])


def block(rng: np.random.Generator, phi: np.ndarray) -> Sums:
    """A block of rows of one joint, whose columns are those of the payload alone."""
    W = rng.standard_normal((ROWS, 1, 10)) * np.array([*np.full(6, 5.0), *np.full(3, 9.8), 4.0])
    residual = W @ phi + rng.standard_normal((ROWS, 1))
    return Sums.none(SIZES, 10).with_rows(W, np.eye(10), residual, np.ones((ROWS, 1)))


def followed(loads: list[np.ndarray], seed: int, rate: float = 1.0) -> Carrying:
    rng = np.random.default_rng(seed)
    found = Carrying(Sums.none(SIZES, 10), rate)
    for k, phi in enumerate(loads):
        found.add(k * BLOCK, (k + 1) * BLOCK, block(rng, phi))
    return found


@settings(max_examples=15, deadline=None)
@given(up=st.integers(60, 120), down=st.integers(20, 60), seed=st.integers(0, 10**6))
def test_what_is_picked_up_and_put_down_is_found_when_it_was(up: int, down: int, seed: int) -> None:
    none = np.zeros(10)
    loads = [none] * up + [HEAVY] * down + [none] * 20
    first, second, third = followed(loads, seed).pieces
    assert abs(second.start - up * BLOCK) <= BLOCK
    assert abs(third.start - (up + down) * BLOCK) <= BLOCK
    for piece, mass in ((first, 0.0), (second, HEAVY[9]), (third, 0.0)):
        phi, covariance = piece.total.solved(1.0)
        assert abs(phi[9] - mass) < 5.0 * np.sqrt(covariance[9, 9])
        assert piece.found <= piece.start + 3 * BLOCK


def test_minutes_of_noise_have_no_change() -> None:
    """Eight, or an hour with `make test-all`, at a rate of a tenth in an hour."""
    assert len(followed([np.zeros(10)] * len(seeds(960, 7200)), 1, rate=0.1).pieces) == 1


def test_a_contact_that_is_over_is_no_payload() -> None:
    none = np.zeros(10)
    loads = [none] * 80 + [HEAVY] * 1 + [none] * 40
    assert len(followed(loads, 5).pieces) == 1


def test_a_change_that_was_placed_too_early_is_placed_anew() -> None:
    """What was told of blocks without the payload is taken back where the next change is found."""
    rng, none = np.random.default_rng(3), np.zeros(10)
    found = followed([none] * 80, 3)
    start, blocks = found.last.total, [block(rng, none) for _ in range(6)]
    own = [sum(blocks[:k], start=found.none) for k in range(len(blocks) + 1)]
    found.pieces.append(Piece(20.0, 21.5, 21.0, 6, own))
    found.noises = found.noises.anew()
    for k, load in enumerate([HEAVY] * 20):
        found.add(21.5 + k * BLOCK, 21.5 + (k + 1) * BLOCK, block(rng, load))
    first, second = found.pieces
    assert (second.start, second.misplaced) == (21.5, 20.0)
    assert (first.start, first.end, first.blocks) == (0.0, 21.5, 80 + 1 + 6)
    np.testing.assert_allclose(first.total.gram, start.gram + own[-1].gram)


def test_memory_does_not_grow() -> None:
    found = followed([np.zeros(10)] * 1000, 2)
    assert len(found.last.sums) < 300
    assert found.last.blocks == 1000
