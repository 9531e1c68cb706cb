"""Kalman smoother over the whole record, tuned by the data.

Whole record, in linear time. Rauch, Tung and Striebel, AIAA J. 3 (1965) 1445, with the backward
recursion of Durbin and Koopman (Time Series Analysis by State Space Methods, section 4.4). Noise
and model are those of maximum likelihood, the intensity that of generalised cross-validation on
held-out positions, unless noise and intensity are given. See docs/theory.md, section "Maximum
likelihood and cross-validation".
Delay: none.
Matched (to second order in the period): position and torque are smoothed alike.
Rule: none is needed, since all settings are found from the data.
noise = 0: standard deviation of the position; 0 to find all settings except the gate from the data.
intensity = 0: spectral density of the white noise, [rad2/s7] for 4 states; 0 to find it as well.
states = 4: number of states, 3 to 5.
damping = frequency = 0: damping [1/s] and frequency [rad/s] of the acceleration process.
gate = 20: number of standard deviations beyond which an innovation is taken for a glitch and left
out (at most 3 in a row).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from scarid_cli.algorithms.choices.settings import require_not_negative
from scarid_cli.algorithms.filters.kalman_method import KalmanMethod
from scarid_cli.algorithms.filters.likelihood import best_model, best_smoothing
from scarid_cli.algorithms.filters.smoothing import (
    ALL,
    DERIVATIVES,
    MatchedSmoothing,
    Smoothing,
)
from scarid_cli.algorithms.processes.matching import over
from scarid_cli.algorithms.processes.method import MatchedForm, Matching
from scarid_cli.algorithms.processes.process import WholeRecord
from scarid_cli.algorithms.processes.records import MatchedRecord, RecordMethod
from scarid_cli.arrays import Array


@dataclass(frozen=True)
class Differentiator(KalmanMethod, RecordMethod):
    noise: float = 0.0
    intensity: float = 0.0

    MATCHING = Matching.SECOND_ORDER
    TUNES_ITSELF = True
    TUNES_TOGETHER = True

    def check_noise(self) -> None:
        require_not_negative(self, "noise", "intensity")

    @property
    def two_sided_order(self) -> int | None:
        return None if self.damping or self.frequency else self.states

    @property
    def is_fitted(self) -> bool:
        return bool(self.noise and self.intensity)

    def fitted(self, x: Array, h: float) -> Differentiator:
        if self.is_fitted:
            return self
        return best_smoothing(best_model(self, x, h), x, h)

    def init(self, x: float, h: float) -> Any:
        return self._known.init(x, h) if self.is_fitted else super().init(x, h)

    def step(self, state: Any, x: Array) -> tuple[Any, tuple[Array, ...]]:
        return self._known.step(state, x) if self.is_fitted else super().step(state, x)

    def finish(self, state: Any) -> tuple[Array, ...]:
        return self._known.finish(state) if self.is_fitted else super().finish(state)

    @property
    def _known(self) -> Smoothing:
        """The smoother with these settings, which does not hold the whole record."""
        return Smoothing(self, DERIVATIVES)

    def smoothed(self, x: Array, h: float) -> tuple[Array, ...]:
        return over(Smoothing(self.fitted(x, h), ALL), x, h)

    def matched(self) -> MatchedForm:
        return MatchedSmoothing(self) if self.is_fitted else MatchedRecord(self)

    def torque_filter(self) -> SmoothedSignal:
        return SmoothedSignal(self.ungated())


@dataclass(frozen=True)
class SmoothedSignal(WholeRecord):
    """A signal smoothed as the method smooths positions, without its derivatives."""

    method: Differentiator

    def over(self, x: Array, h: float) -> tuple[Array, ...]:
        return self.method.smoothed(x, h)[:1]
