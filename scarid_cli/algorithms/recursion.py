"""What the differentiators of the paper share: a recursion whose output needs no later sample."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar, Protocol

import numpy as np

from scarid_cli.arrays import Array

Derivatives = tuple[Array, Array]


class Method(Protocol):
    """The interface of every differentiator (see `differentiators/__init__.py`)."""

    LAG: ClassVar[int]
    PRESETS: ClassVar[dict[str, dict[str, float]]]

    def init(self, q: float, h: float) -> Any: ...
    def step(self, state: Any, q: Array) -> tuple[Any, Derivatives]: ...
    def finish(self, state: Any) -> Derivatives: ...


class Lowpass(Protocol):
    """A causal filter of one column: at rest at its first sample x, sampled every h [s]."""

    def init(self, x: float, h: float) -> Any: ...
    def step(self, state: Any, x: Array) -> tuple[Any, Array]: ...


class Matched(Method, Protocol):
    """A method whose derivatives are exactly those of what `companion` makes of the position.

    tau = W(q, dq, ddq) theta holds between signals of the same instant only. So positions and
    torques pass through the companion, the low-pass that the method is between position and
    derivatives; the derivatives are the central differences of the position so filtered.
    """

    @property
    def companion(self) -> Lowpass | None:
        """None for a method that adds no dynamics."""


@dataclass(frozen=True)
class Recursion:
    """The state of a recursion: its numbers, and the sampling period h [s] they belong to."""

    values: Array
    h: float

    def copy(self) -> Recursion:
        """A state that a kernel may change in place."""
        return replace(self, values=self.values.copy())


class Causal:
    """A method whose output belongs to the sample just taken."""

    LAG: ClassVar[int] = 0
    PRESETS: ClassVar[dict[str, dict[str, float]]] = {}

    def finish(self, state: Any) -> Derivatives:  # noqa: ARG002 (nothing is owed)
        return np.empty(0), np.empty(0)
