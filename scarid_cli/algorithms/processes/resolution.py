"""The resolution of a sensor, as its readings show it."""

from __future__ import annotations

import numpy as np

from scarid_cli.arrays import Array


def resolution_of(x: Array) -> float:
    """The resolution of a sensor as its readings x show it: their smallest step; 0 at rest."""
    steps = np.abs(np.diff(x))
    return float(steps[steps > 0.0].min(initial=np.inf)) if np.any(steps) else 0.0
