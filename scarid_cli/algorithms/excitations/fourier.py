"""Fourier series: periodic motions, random ones, or with --optimise the best ones that are found.

A polynomial brings the joints to rest at both ends of the period, so that it can be repeated
(--repeat) and averaged. The limits hold at every instant.

harmonics = 5: number of sines and cosines of each joint; the first has the duration as its period.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.choices.settings import Validated, require_between
from scarid_cli.algorithms.trajectories.curve import Curve, random_curve
from scarid_cli.algorithms.trajectories.fourier import FourierBasis
from scarid_cli.algorithms.trajectories.limits import Limits
from scarid_cli.arrays import Array


@dataclass(frozen=True)
class Excitation(Validated):
    harmonics: int = 5

    def check(self) -> None:
        require_between(self, 1, 1000, "harmonics")

    def basis(self, limits: Limits, duration: float) -> FourierBasis:  # noqa: ARG002
        """The functions of a motion of this duration [s]."""
        return FourierBasis(duration, self.harmonics)

    def trajectory(
        self, limits: Limits, home: Array, duration: float, rng: np.random.Generator
    ) -> Curve:
        """A random motion of this duration [s] from home (joints) back to home."""
        return random_curve(self.basis(limits, duration), home, limits, rng)
