"""The amplitude spectrum of a record of any length, by the method of Welch."""

from __future__ import annotations

import numpy as np

from scarid_cli.arrays import Array

LENGTH = 2048  # rows of a part; a shorter record is one part


class Spectrum:
    """The amplitude density of columns that are sampled every `period` [s].

    As `scipy.signal.welch`: parts of LENGTH rows that overlap by half, each without its mean and
    under a window of Hann, averaged over the parts of all segments (Welch, IEEE Trans. Audio
    Electroacoustics 15, 1967).
    """

    def __init__(self, columns: int, period: float) -> None:
        self._period = period
        self._waiting = np.empty((columns, 0))
        self._sum: Array | None = None
        self._count = 0

    def add(self, values: Array) -> None:
        """Add the next rows (columns, rows)."""
        self._waiting = np.hstack([self._waiting, values])
        while self._waiting.shape[1] >= LENGTH:
            self._take(self._waiting[:, :LENGTH])
            self._waiting = self._waiting[:, LENGTH // 2 :]

    def gap(self) -> None:
        """A segment ends, whose last unfinished part is left out."""
        self._waiting = self._waiting[:, :0]

    def density(self) -> tuple[Array, Array]:
        """Frequencies [Hz] above zero, and the density of each column [unit / sqrt(Hz)].

        A record that is shorter than a part is taken as a whole. Empty for less than four rows.
        """
        if not self._count and self._waiting.shape[1] >= 4:
            self._take(self._waiting)
        if self._sum is None:
            return np.empty(0), np.empty((len(self._waiting), 0))
        rows = self._rows
        frequencies = np.arange(1, rows // 2 + 1) / (rows * self._period)
        return frequencies, np.sqrt(self._sum[:, 1:] / self._count)

    def _take(self, part: Array) -> None:
        self._rows = rows = part.shape[1]
        window = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(rows) / rows)
        centred = part - part.mean(axis=1, keepdims=True)
        power = np.abs(np.fft.rfft(centred * window, axis=1)) ** 2
        power *= 2.0 * self._period / (window @ window)
        if rows % 2 == 0:
            power[:, -1] /= 2.0  # half the rate is there once
        self._sum = power if self._sum is None else self._sum + power
        self._count += 1
