"""The base class of differentiators: what a method declares of itself, and its matched form."""

from __future__ import annotations

from abc import abstractmethod
from enum import Enum
from typing import ClassVar

from scarid_cli.algorithms.choices.ranges import Range
from scarid_cli.algorithms.choices.settings import Validated
from scarid_cli.algorithms.processes.process import Process
from scarid_cli.arrays import Array


class Matching(Enum):
    """How the matched form brings position, derivatives and torque to one instant."""

    # The method delays nothing: position and torque stay as they are.
    UNFILTERED = "unfiltered"
    # The derivatives are exactly the central differences of the low-passed position, and the
    # torque passes the same low-pass.
    EXACT = "exact"
    # The derivatives are those of a smooth curve through the low-passed position: the same to
    # second order in the sampling period.
    SECOND_ORDER = "second order"
    # The method is nonlinear; position and torque pass its linearisation.
    LINEARISED = "linearised"
    # The method is nonlinear; position, velocity and torque are delayed by what it delays a
    # reference motion.
    MEASURED = "measured delay"


class MatchedForm(Process):
    """Gives position, velocity and acceleration of one instant, and brings torques to it.

    The position is low-passed or delayed, and the derivatives are those of that position.
    """

    @property
    @abstractmethod
    def torque_filter(self) -> Process | None:
        """The process that torques pass; None if the position is unchanged."""


class Method(Validated, Process):
    """A differentiator: a frozen dataclass of settings for one joint.

    It takes positions [rad or m] and gives velocities [1/s] and accelerations [1/s2] of them.
    """

    # Named settings, for example `table1`: as printed in the paper.
    PRESETS: ClassVar[dict[str, dict[str, float]]] = {}
    # The settings that `scarid tune` searches, and where.
    TUNED: ClassVar[dict[str, Range]] = {}
    # How the matched form works; every method declares it, by itself or through its base class.
    MATCHING: ClassVar[Matching]
    # Whether `fitted` chooses settings from the record; then a stage needs the whole record.
    TUNES_ITSELF: ClassVar[bool] = False
    # Whether `fitted` can choose one setting for the positions of several joints (joints, rows).
    TUNES_TOGETHER: ClassVar[bool] = False
    # Whether the method is a Kalman filter or smoother, whose settings have a likelihood.
    HAS_LIKELIHOOD: ClassVar[bool] = False

    # Whether the smoothing is found from the noise of the positions, anew in each column.
    FOLLOWS_NOISE: ClassVar[bool] = False

    @property
    def suits_velocities(self) -> bool:
        """Whether measured velocities can pass it with the settings for positions.

        It must be linear: a low-pass and its differences, whatever passes.
        """
        nonlinear = self.MATCHING in (Matching.LINEARISED, Matching.MEASURED)
        return not nonlinear and not self.FOLLOWS_NOISE

    @property
    def two_sided_order(self) -> int | None:
        """The order of the Butterworth filter that it is, run forwards and backwards; or None."""
        return None

    @property
    def is_fitted(self) -> bool:
        """Whether the settings are known without a record."""
        return not self.TUNES_ITSELF

    def fitted(self, x: Array, h: float) -> Method:  # noqa: ARG002 (for those that tune themselves)
        """The method with settings chosen from the positions x of a whole record."""
        return self

    @abstractmethod
    def matched(self) -> MatchedForm:
        """The phase-matched form of the method, once it is fitted."""
