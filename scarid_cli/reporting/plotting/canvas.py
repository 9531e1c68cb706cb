"""Curves in characters: each character of braille has 2 by 4 dots."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from scarid_cli.arrays import Array

ACROSS, DOWN = 2, 4  # dots of a character
BLANK = 0x2800  # the first character of braille, whose last eight bits are its dots
BITS = np.array([[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]])

Limits = tuple[float, float]
Numbered = npt.NDArray[Any]


class Canvas:
    """So many characters, with a layer of dots for each curve."""

    def __init__(self, width: int, height: int, x: Limits, y: Limits) -> None:
        self._size = (DOWN * height, ACROSS * width)
        self._x, self._y = x, y
        self._layers: list[npt.NDArray[np.bool_]] = []

    def curve(self, points: Array) -> None:
        """Join the points (2, n) by lines; nan breaks the curve. Each point inside has its dot."""
        rows, columns = self._size
        across = _scaled(points[0], self._x) * (columns - 1)
        down = (1.0 - _scaled(points[1], self._y)) * (rows - 1)
        # A curve of one point, and the last point of a curve, are lines of no length.
        starts = np.stack([across, down])
        ends = np.hstack([starts[:, 1:], starts[:, -1:]])
        broken = np.isnan(ends).any(axis=0)
        ends[:, broken] = starts[:, broken]
        known = np.isfinite(starts).all(axis=0)
        dots = np.zeros(self._size, dtype=np.bool_)
        dots[_dots(starts[:, known], ends[:, known], self._size)] = True
        self._layers.append(dots)

    def characters(self) -> Iterator[list[tuple[str, int | None]]]:
        """Each line: its characters, and the number of the first curve in each, or None."""
        shape = (self._size[0] // DOWN, DOWN, self._size[1] // ACROSS, ACROSS)
        layers = np.array(self._layers or [np.zeros(self._size, dtype=np.bool_)])
        cells = layers.reshape(len(layers), *shape).swapaxes(2, 3)
        codes = BLANK + (cells.any(axis=0) * BITS).sum(axis=(2, 3))
        used = cells.any(axis=(3, 4))
        first = used.argmax(axis=0)
        for line, numbers, any_used in zip(codes, first, np.any(used, axis=0), strict=True):
            yield [
                (chr(code), int(number) if seen else None)
                for code, number, seen in zip(line, numbers, any_used, strict=True)
            ]


def _scaled(values: Array, limits: Limits) -> Array:
    low, high = limits
    return (values - low) / (high - low)


def _dots(starts: Array, ends: Array, size: tuple[int, int]) -> tuple[Numbered, Numbered]:
    """The rows and columns of the dots on the lines between these points, within the canvas."""
    rows, columns = size
    longest = np.abs(ends - starts).max(axis=0, initial=0.0)
    counts = np.ceil(np.minimum(longest, 4 * (rows + columns))).astype(int) + 1
    line = np.repeat(np.arange(len(counts)), counts)
    step = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
    share = step / np.maximum(counts - 1, 1)[line]
    across, down = np.rint(starts[:, line] + share * (ends - starts)[:, line])
    inside = (across >= 0) & (across < columns) & (down >= 0) & (down < rows)
    return down[inside].astype(int), across[inside].astype(int)
