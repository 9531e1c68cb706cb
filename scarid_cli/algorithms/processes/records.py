"""Methods that smooth a whole record, and their matched form."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass

from scarid_cli.algorithms.processes.method import MatchedForm, Method
from scarid_cli.algorithms.processes.process import Process, Samples, WholeRecord
from scarid_cli.arrays import Array


class RecordMethod(WholeRecord, Method):
    """A method that gets position, velocity and acceleration from all samples of a record."""

    @abstractmethod
    def smoothed(self, x: Array, h: float) -> tuple[Array, ...]:
        """Position, velocity and acceleration of the positions x, sampled every h [s]."""

    @abstractmethod
    def torque_filter(self) -> Process:
        """The process that smooths a torque as the method smooths the position."""

    def over(self, x: Array, h: float) -> tuple[Array, ...]:
        return self.smoothed(x, h)[1:]

    def matched(self) -> MatchedForm:
        return MatchedRecord(self)


@dataclass(frozen=True)
class MatchedRecord(WholeRecord, MatchedForm):
    """The smoothed position with its derivatives, as the method has them."""

    method: RecordMethod

    @property
    def torque_filter(self) -> Process:
        return self.method.torque_filter()

    def init(self, x: float, h: float) -> Samples:
        return self.method.init(x, h)

    def over(self, x: Array, h: float) -> tuple[Array, ...]:
        return self.method.smoothed(x, h)
