"""The base classes of estimators, what an estimator declares, and what it returns."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, Self

import numpy as np

from scarid_cli.algorithms.choices.settings import GIVEN, Validated
from scarid_cli.algorithms.regression.information import Fit
from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.algorithms.regression.whitening import ColouredNoise
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array


@dataclass(frozen=True)
class Scores:
    """The equations Z' (y - W theta) = 0 that the estimates solve, from which robust errors follow.

    `whitening` (joints, joints) is the matrix that the rows of each sample were multiplied by.
    `huber` is the whitened residual above which Huber's weights reduce the weight of a row.
    `instruments` (samples, joints, parameters) take the place of W in Z. `rows` are the rows in
    which the problem is linear, if they are not those that the estimator was given. `forgetting` is
    the factor by which the weight of a row decreases with each later sample. By `noise` the rows
    were whitened in time before all that, and only some of them were kept.
    """

    whitening: Array | None = None
    huber: float = float("inf")
    instruments: Array | None = None
    rows: Rows | None = None
    noise: ColouredNoise | None = None
    forgetting: float = 1.0


@dataclass(frozen=True)
class Estimation:
    """The result of an estimator.

    `scores` is None if the estimates solve no such equations, as with a Kalman filter. `added` has
    the names and units of parameters beyond the robot's, and `extra` whatever else the estimator
    reports.
    """

    fit: Fit
    scores: Scores | None = field(default_factory=Scores)
    added: tuple[tuple[str, str], ...] = ()
    extra: dict[str, Any] = field(default_factory=dict)

    @property
    def noise(self) -> ColouredNoise | None:
        """The noise that the rows were whitened by, if they were."""
        return self.scores.noise if self.scores else None

    @property
    def weighted(self) -> bool:
        """Whether the rows were weighted by their residuals."""
        return self.scores is not None and self.scores.whitening is not None


class BaseEstimator(Validated, ABC):
    """What all estimators share, and what each of them declares.

    RECURSIVE: the estimator gives estimates after every sample. HOLDS: it keeps all rows in memory.
    INITIAL: it starts from initial parameters. REFERENCE: it needs the reference that the robot
    followed. FOLLOWS: its rows are those of the reference, and it needs no measured motion. ALIGNS:
    the delay of the torques can be fitted as one more parameter.
    """

    RECURSIVE: ClassVar[bool] = False
    HOLDS: ClassVar[bool] = False
    INITIAL: ClassVar[bool] = False
    REFERENCE: ClassVar[bool] = False
    FOLLOWS: ClassVar[bool] = False
    ALIGNS: ClassVar[bool] = True

    def for_robot(self, robot: Robot) -> Self:  # noqa: ARG002 (most do not depend on it)
        """The estimator for this robot."""
        return self

    def widened(self, columns: int) -> Self:  # noqa: ARG002 (most take as many as there are)
        """The estimator for rows with so many more columns, of nuisance parameters."""
        return self

    def quick(self) -> BaseEstimator:
        """The estimator with which the delay of the torques is searched for."""
        return self

    @abstractmethod
    def init(self, initial: Array) -> Any:
        """The state before the first row; `initial` are the initial parameters, or zeros."""

    @abstractmethod
    def step(self, state: Any, rows: Rows, *, trace: bool = False) -> tuple[Any, Array]:
        """The state after these rows; with `trace`, the estimates (samples, parameters) as well."""

    @abstractmethod
    def fit(self, state: Any) -> Estimation:
        """The result from all rows so far."""

    def of_rows(self, rows: Rows, initial: Array | None = None) -> Estimation:
        """The result from these rows alone; the initial parameters are zeros by default."""
        start = np.zeros(rows.W.shape[2]) if initial is None else initial
        return self.fit(self.step(self.init(start), rows)[0])


@dataclass(frozen=True)
class RobotEstimator(BaseEstimator):
    """An estimator that needs the robot itself, which `for_robot` gives it."""

    given: Robot | None = field(default=None, metadata=GIVEN)

    def for_robot(self, robot: Robot) -> Self:
        return replace(self, given=robot)

    @property
    def robot(self) -> Robot:
        """The robot that was given."""
        assert self.given is not None
        return self.given


class HoldingEstimator(BaseEstimator):
    """An estimator that keeps all rows and solves for the estimates in `fit`."""

    HOLDS: ClassVar[bool] = True

    def init(self, initial: Array) -> list[Rows]:  # noqa: ARG002 (W has as many columns)
        return []

    def step(
        self,
        state: list[Rows],
        rows: Rows,
        *,
        trace: bool = False,  # noqa: ARG002 (there are no estimates before the end)
    ) -> tuple[list[Rows], Array]:
        return [*state, rows], np.empty((0, rows.W.shape[2]))
