"""The interface of everything that a stage runs over a column: filters, recursions, smoothers."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from math import inf
from typing import Any, ClassVar

import numpy as np

from scarid_cli.arrays import Array


class Process(ABC):
    """Takes one column and gives one or more: derivatives of positions, filtered torques.

    SETTLING_ROWS declares how many rows before and after a step the output is off, where that is
    known; otherwise `matching.settling_rows` measures it.
    """

    SETTLING_ROWS: ClassVar[tuple[int, int] | None] = None

    @abstractmethod
    def lag(self, h: float) -> float:
        """The number of later rows that the output of a row waits for; inf for all of them.

        h: sampling period [s].
        """

    @abstractmethod
    def init(self, x: float, h: float) -> Any:
        """The state before the first sample x of a column sampled every h [s]."""

    @abstractmethod
    def step(self, state: Any, x: Array) -> tuple[Any, tuple[Array, ...]]:
        """The state after the samples x, and the output of the rows that are complete by then.

        The state that is passed in is not changed.
        """

    @abstractmethod
    def finish(self, state: Any) -> tuple[Array, ...]:
        """The output of the rows that still wait at the end of the record."""


@dataclass(frozen=True)
class Recursion:
    """The state of a recursion: its numbers, and the sampling period h [s] they belong to."""

    values: Array
    h: float

    def copy(self) -> Recursion:
        """A state that a kernel may change in place."""
        return replace(self, values=self.values.copy())


class Causal(Process):
    """A process whose output belongs to the sample just taken."""

    def lag(self, h: float) -> float:  # noqa: ARG002 (the same at every rate)
        return 0

    def finish(self, state: Any) -> tuple[Array, ...]:  # noqa: ARG002 (no row waits)
        return ()


@dataclass(frozen=True)
class Samples:
    """The samples of a record so far: those just taken, and a link to those before them."""

    last: Array
    before: Samples | None
    h: float

    def joined(self) -> Array:
        """All samples, from the first on."""
        parts = []
        samples: Samples | None = self
        while samples:
            parts.append(samples.last)
            samples = samples.before
        return np.concatenate(parts[::-1])


class WholeRecord(Process):
    """A process that needs the whole record before it gives the first row of its output."""

    def lag(self, h: float) -> float:  # noqa: ARG002 (the same at every rate)
        return inf

    def init(self, x: float, h: float) -> Samples:  # noqa: ARG002 (the first step brings it)
        return Samples(np.empty(0), None, h)

    def step(self, state: Samples, x: Array) -> tuple[Samples, tuple[Array, ...]]:
        return Samples(x, state, state.h), ()

    def finish(self, state: Samples) -> tuple[Array, ...]:
        return self.over(state.joined(), state.h)

    @abstractmethod
    def over(self, x: Array, h: float) -> tuple[Array, ...]:
        """The output for all samples x of a record, sampled every h [s]."""
