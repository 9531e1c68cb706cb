"""The products of the columns of a regression, joint by joint."""

from __future__ import annotations

import numpy as np

from scarid_cli.arrays import Array, Marks


def grams(W: Array, tau: Array, counts: Marks) -> Array:
    """[W y]'[W y] of the rows that count (joints, parameters + 1, parameters + 1).

    W (samples, joints, parameters), tau and counts (joints, samples). Many columns are zero in the
    rows of a joint: those of the links before it, and the friction of the others.
    """
    joints, count = len(tau), W.shape[2]
    sums = np.zeros((joints, count + 1, count + 1))
    for j, chosen in enumerate(counts):
        own = W[chosen, j]
        places = np.append(np.flatnonzero(own.any(axis=0)), count)
        rows = np.empty((len(own), len(places)))
        rows[:, :-1], rows[:, -1] = own[:, places[:-1]], tau[j, chosen]
        sums[j, places[:, None], places] = rows.T @ rows
    return sums
