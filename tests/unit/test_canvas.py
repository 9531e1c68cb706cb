"""Curves in characters, and the spectra of `scarid plot`."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import signal

from scarid_cli.reporting.plotting.canvas import BITS, BLANK, Canvas
from scarid_cli.reporting.plotting.spectrum import LENGTH, Spectrum


def dots(canvas: Canvas) -> np.ndarray:
    """The dots of the characters, by the table of braille in Unicode."""
    lines = [[ord(c) - BLANK for c, _ in line] for line in canvas.characters()]
    cells = np.array(lines)[:, :, None, None] & BITS != 0
    return cells.swapaxes(1, 2).reshape(4 * cells.shape[0], 2 * cells.shape[1])


def drawn(points: list[list[float]], width: int = 5, height: int = 3) -> np.ndarray:
    canvas = Canvas(width, height, (0.0, 1.0), (0.0, 1.0))
    canvas.curve(np.array(points, dtype=float))
    return dots(canvas)


def test_a_level_line_is_one_row_of_dots() -> None:
    found = drawn([[0, 1], [1, 1]])
    assert found[0].all()
    assert found[1:].sum() == 0


def test_a_diagonal_has_a_dot_in_every_column_next_to_the_last() -> None:
    found = drawn([[0, 1], [0, 1]])
    assert found[-1, 0]
    assert found[0, -1]
    rows = [np.flatnonzero(column) for column in found.T]
    assert all(len(r) for r in rows)
    assert all(np.diff(np.flatnonzero(found.any(axis=1))) == 1)


def test_nan_breaks_a_curve_and_keeps_single_points() -> None:
    found = drawn([[0, np.nan, 0.5, np.nan, 1], [0, np.nan, 1, np.nan, 0]])
    assert np.argwhere(found).tolist() == [[0, 4], [11, 0], [11, 9]]


def test_what_lies_outside_is_left_out() -> None:
    assert not drawn([[-3, -2], [5, 7]]).any()


def test_each_point_has_its_dot() -> None:
    """So no peak is lost, however many rows share a column of dots."""
    t, x = np.linspace(0.0, 1.0, 5000), np.zeros(5000)
    x[1234] = 1.0
    assert drawn([list(t), list(x)])[0].sum() == 1


def test_the_first_curve_of_a_character_names_it() -> None:
    canvas = Canvas(2, 1, (0.0, 1.0), (0.0, 1.0))
    canvas.curve(np.array([[0.0, 0.3], [0.0, 0.0]]))
    canvas.curve(np.array([[0.0, 1.0], [1.0, 1.0]]))
    assert [curve for _, curve in next(canvas.characters())] == [0, 1]


@pytest.mark.parametrize("rows", [100, LENGTH, 3 * LENGTH + 17])
def test_a_spectrum_is_that_of_scipy(rows: int) -> None:
    period, rng = 0.004, np.random.default_rng(1)
    values = rng.normal(size=(2, rows)).cumsum(axis=1)
    found = Spectrum(2, period)
    for part in np.array_split(values, 7, axis=1):
        found.add(part)
    frequencies, density = found.density()
    length = min(rows, LENGTH)
    expected = signal.welch(values, 1.0 / period, nperseg=length, noverlap=length // 2)
    assert frequencies == pytest.approx(expected[0][1:])
    assert density == pytest.approx(np.sqrt(expected[1][:, 1:]), rel=1e-6)


def test_no_part_of_a_spectrum_extends_across_a_gap() -> None:
    whole, parts = Spectrum(1, 0.01), Spectrum(1, 0.01)
    values = np.random.default_rng(2).normal(size=(1, LENGTH))
    whole.add(values)
    parts.add(values)
    parts.add(np.full((1, 900), 1e9))
    parts.gap()
    parts.add(values)
    assert parts.density()[1] == pytest.approx(whole.density()[1])
