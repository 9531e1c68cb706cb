"""What a stage runs over a column: recursions, filters and smoothers behind one interface."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf
from typing import Any, ClassVar, Protocol

import numpy as np

from scarid_cli.algorithms.choices.ranges import Range
from scarid_cli.arrays import Array


class Process(Protocol):
    """One column in, one or more out: positions to derivatives, torques to filtered torques.

    The output of a row waits for `lag(h)` more rows, sampled every h [s]; for all of them if that
    is inf. `init(x, h)` is the state before the first sample x.
    """

    def lag(self, h: float) -> float: ...
    def init(self, x: float, h: float) -> Any: ...
    def step(self, state: Any, x: Array) -> tuple[Any, tuple[Array, ...]]: ...
    def finish(self, state: Any) -> tuple[Array, ...]: ...


class Matched(Process, Protocol):
    """Position, velocity and acceleration of one instant, and how to bring a torque there.

    The position is low-passed or delayed, and the derivatives are its own.
    """

    @property
    def torque_filter(self) -> Process | None:
        """What torques go through; None if the position is as it was."""


class Method(Process, Protocol):
    """The interface of every differentiator (see `differentiators/__init__.py`)."""

    PRESETS: ClassVar[dict[str, dict[str, float]]]
    TUNED: ClassVar[dict[str, Range]]

    def matched(self) -> Matched: ...


@dataclass(frozen=True)
class Recursion:
    """The state of a recursion: its numbers, and the sampling period h [s] they belong to."""

    values: Array
    h: float

    def copy(self) -> Recursion:
        """A state that a kernel may change in place."""
        return replace(self, values=self.values.copy())


class Causal:
    """A process whose output belongs to the sample just taken."""

    PRESETS: ClassVar[dict[str, dict[str, float]]] = {}
    TUNED: ClassVar[dict[str, Range]] = {}

    def lag(self, h: float) -> float:  # noqa: ARG002 (the same at every rate)
        return 0

    def finish(self, state: Any) -> tuple[Array, ...]:  # noqa: ARG002 (nothing is owed)
        return ()


@dataclass(frozen=True)
class Record:
    """A record that grows: the samples just taken, and those before them."""

    last: Array
    before: Record | None
    h: float

    def joined(self) -> Array:
        parts = []
        record: Record | None = self
        while record:
            parts.append(record.last)
            record = record.before
        return np.concatenate(parts[::-1])


class Whole:
    """A process that needs the whole record before the first row of its output."""

    PRESETS: ClassVar[dict[str, dict[str, float]]] = {}
    TUNED: ClassVar[dict[str, Range]] = {}

    def lag(self, h: float) -> float:  # noqa: ARG002 (the same at every rate)
        return inf

    def init(self, x: float, h: float) -> Record:  # noqa: ARG002 (the record has it)
        return Record(np.empty(0), None, h)

    def step(self, state: Record, x: Array) -> tuple[Record, tuple[Array, ...]]:
        return Record(x, state, state.h), ()

    def finish(self, state: Record) -> tuple[Array, ...]:
        return self.over(state.joined(), state.h)

    def over(self, x: Array, h: float) -> tuple[Array, ...]:
        """The output for all samples x of a record."""
        raise NotImplementedError
