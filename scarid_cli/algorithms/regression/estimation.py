"""What an estimator is, what it may need, and what it returns: numbers, and how they came about."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import Any, ClassVar, Self

import numpy as np

from scarid_cli.algorithms.choices.settings import Validated
from scarid_cli.algorithms.regression.information import Fit
from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array


@dataclass(frozen=True)
class Scores:
    """The equations Z' (y - W theta) = 0 that the estimates solve, which tell their robust errors.

    `whitening` (joints, joints) is what the rows of a sample were multiplied by; `huber` the
    whitened residual from which a row counts less; `instruments` (samples, joints, parameters)
    take the place of W in Z. `rows` are those in which the fit is linear, where they are not those
    that the estimator was given.
    """

    whitening: Array | None = None
    huber: float = float("inf")
    instruments: Array | None = None
    rows: Rows | None = None


@dataclass(frozen=True)
class Estimation:
    """What an estimator found.

    `scores` is None where no such equations hold for the rows as they are: a filter, an estimate
    that forgets. `added` are names and units of parameters beyond the robot's, `extra` is whatever
    else there is to report.
    """

    fit: Fit
    scores: Scores | None = field(default_factory=Scores)
    added: tuple[tuple[str, str], ...] = ()
    extra: dict[str, Any] = field(default_factory=dict)


class BaseEstimator(Validated, ABC):
    """What all estimators share, and what each of them declares.

    RECURSIVE: there are estimates after every sample. HOLDS: the state is all rows so far.
    INITIAL: the estimates start from initial parameters. REFERENCE: the rows need the reference
    that the robot followed. ALIGNS: the delay of the torques can be fitted as one more parameter.
    """

    RECURSIVE: ClassVar[bool] = False
    HOLDS: ClassVar[bool] = False
    INITIAL: ClassVar[bool] = False
    REFERENCE: ClassVar[bool] = False
    ALIGNS: ClassVar[bool] = True

    def for_robot(self, robot: Robot) -> Self:  # noqa: ARG002 (most need not know it)
        """The estimator for the rows of this robot."""
        return self

    def widened(self) -> Self:
        """The estimator for rows with one more column, the delay of the torques."""
        return self

    @abstractmethod
    def init(self, initial: Array) -> Any:
        """The state before the first row, given initial parameters or zeros."""

    @abstractmethod
    def step(self, state: Any, rows: Rows, *, trace: bool = False) -> tuple[Any, Array]:
        """The state after these rows; with `trace`, the estimates (samples, parameters) as well."""

    @abstractmethod
    def fit(self, state: Any) -> Estimation:
        """What the rows so far say."""


class HoldingEstimator(BaseEstimator):
    """An estimator whose state is all rows so far: what it does with them is its `fit`."""

    HOLDS: ClassVar[bool] = True

    def init(self, initial: Array) -> list[Rows]:  # noqa: ARG002 (W has as many columns)
        return []

    def step(
        self,
        state: list[Rows],
        rows: Rows,
        *,
        trace: bool = False,  # noqa: ARG002 (there is nothing before the end)
    ) -> tuple[list[Rows], Array]:
        return [*state, rows], np.empty((0, rows.W.shape[2]))
