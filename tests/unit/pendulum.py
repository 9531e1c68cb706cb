"""The vertical arm of two joints, and a motion of it with exact derivatives."""

from __future__ import annotations

import numpy as np

from scarid_cli.algorithms.beyond.model import Model
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.arrays import Array

ARM = load("planar2-gravity")
MODEL = Model(ARM, list(range(len(ARM.parameters))))
H = 0.005  # s
SINES = [[(1.0, 0.31, 0.0), (0.4, 0.83, 1.0)], [(0.8, 0.23, 2.0), (0.3, 1.1, 0.5)]]


def motion(samples: int = 6000) -> Array:
    """Positions, velocities and accelerations (3, joints, samples) of sums of sines."""
    t = np.arange(samples) * H
    found = np.zeros((3, 2, samples))
    for joint, sines in enumerate(SINES):
        for size, frequency, phase in sines:
            w = 2.0 * np.pi * frequency
            found[0, joint] += size * np.sin(w * t + phase)
            found[1, joint] += size * w * np.cos(w * t + phase)
            found[2, joint] -= size * w * w * np.sin(w * t + phase)
    return found
