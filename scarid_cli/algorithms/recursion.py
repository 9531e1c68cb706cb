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
