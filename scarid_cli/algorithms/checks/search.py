"""The search for what explains a log far better than its description, a step after the other."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from scarid_cli.algorithms.checks.model import Fit

FALL = 0.5  # of the mean square residual: what is left at most if something else is preferred
ALIKE = 1.1  # times the mean square residual of one joint, for the same explanation
STEPS = 3  # changes that are looked for, one after the other

T = TypeVar("T")


@dataclass(frozen=True)
class Explained(Generic[T]):
    """What is taken to be the case, and the fit of the log with it."""

    case: T
    fit: Fit


def searched(
    found: Explained[T],
    fitted: Callable[[T], Fit],
    neighbours: Callable[[Explained[T]], list[T]],
    fall: float = FALL,
) -> Explained[T]:
    """The case that leaves far less of the torques than all that come before it, if there is one.

    The first of these is what was `found`. `neighbours` are the cases that are tried from one to
    the next, and `fall` is what one must leave at most of the mean square residual. Of those that
    explain the torques alike the one is taken whose friction brakes.
    """
    for _ in range(STEPS):
        others = [Explained(case, fitted(case)) for case in neighbours(found)]
        least = min(other.fit.misfit for other in others)
        if least > found.fit.misfit + np.log(fall):
            break
        alike = [other for other in others if other.fit.misfit < least - np.log(fall)]
        found = min(alike, key=lambda other: (len(other.fit.driving), other.fit.misfit))
    return found
