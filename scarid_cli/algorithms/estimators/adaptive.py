"""Recursive least squares that forgets as much as the data say (variable forgetting; section 5).

Parameters walk at random. A bank of Kalman filters has one that does not let them, some in which
all walk, and some in which friction alone does, each with its own intensity. The likelihood of what
comes says which of them is right, and the estimates are their mean (interacting multiple models;
Blom and Bar-Shalom, IEEE Trans. Autom. Control 33, 1988). So nothing is forgotten of a robot that
stays as it is, and warming friction or a payload is followed.
lasting = 60: time for which an intensity of the walk stays right [s].
p0 = 100: initial covariance, P0 = p0 I.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.choices.settings import require_positive
from scarid_cli.algorithms.regression.estimation import Estimation, RobotEstimator, Scores
from scarid_cli.algorithms.regression.information import (
    Fit,
    NotIdentifiableError,
    inverse_deviations,
)
from scarid_cli.algorithms.regression.rows import Rows, joined
from scarid_cli.arrays import Array

BLOCK = 0.25  # s: rows are taken together, as the noise of torques is alike for as long
INDEPENDENT = 20.0  # rows a second, of a torque with a bandwidth of 10 Hz: until it is known
WINDOW = 8  # blocks, in which parameters hardly move
LONGEST = 32  # blocks of a window that does not tell
MOST = 0.7  # correlation of neighbouring blocks that is believed
UNKNOWN = 0.01  # of the mean square torque: the noise before the first window is complete
# Of the torque of a joint: by how much a parameter that walks changes it in a second (its standard
# deviation). The last one is a payload that is picked up.
ALL = (0.001, 0.01, 0.1)
FRICTION = (0.0003, 0.001, 0.003, 0.01, 0.1)
FILTERS = 1 + len(ALL) + len(FRICTION)
SETTLING = 10.0  # s, over which the noise of a joint is averaged
LEAST = 1e-9  # of the rms torque of a joint: a smaller noise is rounding


@dataclass(frozen=True)
class Bank:
    """The filters after so many blocks, and the rows of a block that is not complete.

    `means` (filters, parameters) and `covariances` (filters, parameters, parameters) are those of
    the parameters, `weights` (filters) the probabilities of the filters. `gram` (parameters,
    parameters) is the information of all rows. `noise` and `torque` (joints) are the mean squares
    of the noise and of the torques, and `alike` (joints) how many times the variance of a mean is
    that of white noise, as so many `windows` of blocks say; `window` has the blocks of the next
    one. So many `rows` have come, in so many seconds (`seen`).
    """

    means: Array
    covariances: Array
    weights: Array
    gram: Array
    noise: Array
    torque: Array
    alike: Array
    seen: float = 0.0
    rows: float = 0.0
    windows: int = 0
    held: tuple[Rows, ...] = ()
    window: tuple[Rows, ...] = ()

    @property
    def estimates(self) -> Array:
        """The mean of the filters (parameters)."""
        return np.asarray(self.weights @ self.means)

    @property
    def covariance(self) -> Array:
        """That of the estimates, with the scatter of the filters (parameters, parameters)."""
        apart = self.means - self.estimates
        whole = np.tensordot(self.weights, self.covariances, 1)
        return np.asarray(whole + (self.weights[:, None] * apart).T @ apart)


@dataclass(frozen=True)
class Estimator(RobotEstimator):
    lasting: float = 60.0
    p0: float = 100.0

    RECURSIVE: ClassVar[bool] = True
    INITIAL: ClassVar[bool] = True
    ALIGNS: ClassVar[bool] = False

    def check(self) -> None:
        require_positive(self, "lasting", "p0")

    def init(self, initial: Array) -> Bank:
        count, p = FILTERS, len(initial)
        weights = np.full(count, 0.5 / (count - 1))
        weights[0] = 0.5
        return Bank(
            means=np.tile(initial, (count, 1)),
            covariances=np.tile(self.p0 * np.eye(p), (count, 1, 1)),
            weights=weights,
            gram=np.zeros((p, p)),
            noise=np.zeros(0),
            torque=np.zeros(0),
            alike=np.zeros(0),
        )

    def step(self, state: Bank, rows: Rows, *, trace: bool = False) -> tuple[Bank, Array]:
        length = max(1, round(BLOCK / rows.h)) if rows.h > 0.0 else 1
        estimates = np.empty((rows.samples if trace else 0, state.means.shape[1]))
        number = rows.at // length
        edges = np.flatnonzero(np.diff(number)) + 1
        for start, stop in zip([0, *edges], [*edges, rows.samples], strict=True):
            held = state.held
            if held and int(held[-1].at[-1]) // length != int(number[start]):
                state = self._after(state)
            state = replace(state, held=(*state.held, rows.part(slice(start, stop))))
            if trace:
                estimates[start:stop] = state.estimates
        return state, estimates

    def fit(self, state: Bank) -> Estimation:
        state = self._after(state)
        if state.window and not state.windows:  # a short log
            seconds = BLOCK
            state = _with_noise(state, seconds, patient=False)
            state = self._absorbed(state, state.window, clear=True)
        gram = state.gram
        size = np.sqrt(np.diag(gram))
        scaled = gram / np.outer(size, size) if size.all() else np.zeros_like(gram)
        if not np.linalg.cond(scaled) < 1e14:
            raise NotIdentifiableError(np.asarray(np.linalg.eigh(gram)[1][:, 0], np.float64))
        covariance = state.covariance
        fit = Fit(
            estimates=state.estimates,
            unit_covariance=covariance,
            variance=1.0,
            condition=float("nan"),
        )
        whitening = np.diag(inverse_deviations(np.sqrt(state.noise)))
        return Estimation(fit, Scores(whitening=whitening, forgetting=self._factor(state)))

    def _factor(self, state: Bank) -> float:
        """The constant factor that would keep as much of the information about the parameters."""
        likeliest = state.covariances[np.argmax(state.weights)]
        kept = np.diag(np.linalg.inv(state.gram)) / np.diag(likeliest)
        share = float(np.clip(kept, 0.0, 1.0).mean())
        return 1.0 if share > 0.5 else 1.0 - 1.0 / max(share * state.rows, 2.0)

    def _after(self, state: Bank) -> Bank:
        """The bank after the block that is held.

        The first blocks wait until the noise is known.
        """
        if not state.held:
            return state
        rows = joined(state.held)
        seconds = rows.samples * rows.h or BLOCK
        state = replace(state, held=(), seen=state.seen + seconds)
        if not (rows.scales > 0.0).any():
            return state
        state = _with_torque(state, rows, seconds)
        waiting = not state.windows
        state = replace(state, window=(*state.window, rows))
        if len(state.window) >= WINDOW:
            state = _with_noise(state, seconds, patient=len(state.window) < LONGEST)
        if not state.windows:
            return state
        return self._absorbed(state, state.window if waiting else (rows,), clear=waiting)

    def _absorbed(self, state: Bank, parts: Sequence[Rows], *, clear: bool) -> Bank:
        """The bank after these blocks, whose noise is known."""
        for rows in parts:
            weights = rows.scales / np.sqrt(state.noise * state.alike)
            W = (rows.W * weights[:, :, None]).reshape(-1, rows.W.shape[2])
            y = (rows.y * weights).ravel()
            state = replace(state, gram=state.gram + W.T @ W, rows=state.rows + rows.samples)
            walked = self._walked(state, rows.samples * rows.h or BLOCK)
            state = self._updated(walked, W.T @ W, W.T @ y, float(y @ y))
        return replace(state, window=()) if clear else state

    def _walked(self, state: Bank, seconds: float) -> Bank:
        """The bank after the walk of so many seconds, and after the intensities may have changed.

        The filters are mixed as likely as each of them was another one before.
        """
        count = len(state.weights)
        changed = min(0.5, seconds / self.lasting)
        moves = np.full((count, count), changed / (count - 1))
        np.fill_diagonal(moves, 1.0 - changed)
        joint = state.weights[:, None] * moves  # from a filter (row) to another one (column)
        weights = joint.sum(axis=0)
        share = joint / weights
        means = share.T @ state.means
        apart = state.means[:, None] - means[None]  # (from, to, parameters)
        scatter = np.einsum("ft,ftp,ftq->tpq", share, apart, apart)
        covariances = np.tensordot(share.T, state.covariances, 1) + scatter
        # A filter whose parameters stay does not take over how uncertain the others are.
        means[0], covariances[0] = state.means[0], state.covariances[0]
        covariances += self._walks(state) * seconds
        return replace(state, means=means, covariances=covariances, weights=weights)

    def _walks(self, state: Bank) -> Array:
        """The covariance that a second adds to each filter (filters, parameters, parameters)."""
        power = np.diag(state.gram) / max(state.rows, 1.0)  # per row, in units of the noise
        torque = float(np.max(state.torque / np.maximum(state.noise, 1e-300)))
        unit = torque / np.maximum(power, 1e-12 * power.max(initial=1e-300))
        terms = [parameter.term for parameter in self.robot.parameters]
        rubs = np.array([term.NEVER_NEGATIVE for term in terms])
        walks = np.zeros((len(state.weights), len(unit), len(unit)))
        for k, size in enumerate(ALL, start=1):
            walks[k] = np.diag(size**2 * unit)
        for k, size in enumerate(FRICTION, start=1 + len(ALL)):
            walks[k] = np.diag(size**2 * unit * rubs)
        return walks

    def _updated(self, state: Bank, gram: Array, moment: Array, square: float) -> Bank:
        """The bank after a block with W'W, W'y and y'y in units of the noise."""
        P, m = state.covariances, state.means
        system = np.eye(len(gram)) + P @ gram
        covariances = np.linalg.solve(system, P)
        covariances = 0.5 * (covariances + covariances.swapaxes(1, 2))
        left = moment - m @ gram
        means = m + np.einsum("fpq,fq->fp", covariances, left)
        miss = square - 2.0 * m @ moment + np.einsum("fp,pq,fq->f", m, gram, m)
        explained = np.einsum("fp,fpq,fq->f", left, covariances, left)
        _, size = np.linalg.slogdet(system)
        likelihood = -0.5 * (size + miss - explained)
        weights = state.weights * np.exp(likelihood - likelihood.max())
        return replace(state, means=means, covariances=covariances, weights=weights / weights.sum())


def _with_torque(state: Bank, rows: Rows, seconds: float) -> Bank:
    """The bank with the mean square torque of each joint over all rows that count."""
    counted = rows.scales > 0.0
    squares = np.sum((rows.y * counted) ** 2, axis=0) / np.maximum(counted.sum(axis=0), 1)
    torque = state.torque if len(state.torque) else squares
    return replace(state, torque=torque + min(1.0, seconds / state.seen) * (squares - torque))


def _with_noise(state: Bank, seconds: float, *, patient: bool) -> Bank:
    """The bank with what its window says about the noise, which is then complete.

    One that does not tell goes on if there is time; then the noise is guessed, until it is known.
    """
    found = _noise_of(state.window)
    if found is None and patient:
        return state
    first = not state.windows
    least = LEAST**2 * state.torque.max(initial=0.0) + 1e-300
    if found is None:
        if not first:
            return replace(state, window=())
        h = state.window[0].h
        apart = max(1.0, 1.0 / (INDEPENDENT * h)) if h > 0.0 else 1.0
        torque = np.maximum(state.torque, 1e-2 * state.torque.max(initial=0.0))
        found = UNKNOWN * torque, np.full(len(torque), apart)
    noise, alike = found
    if first:
        kept = state.window  # which is still to be absorbed
        return replace(state, noise=np.maximum(noise, least), alike=alike, windows=1, window=kept)
    rate = max(1.0 / (1.0 + state.windows), WINDOW * seconds / SETTLING)
    return replace(
        state,
        noise=np.maximum(state.noise + rate * (noise - state.noise), least),
        alike=state.alike + rate * (alike - state.alike),
        windows=state.windows + 1,
        window=(),
    )


def _noise_of(window: Sequence[Rows]) -> tuple[Array, Array] | None:
    """The variance of the noise of each joint, and how many times that of a mean is larger.

    It is that of the residuals of a fit to the window alone, in which parameters hardly move; the
    variance of the sums of blocks shows how alike the noise of rows is. None if the window does not
    tell.
    """
    rows = joined(window)
    joints, p = rows.y.shape[1], rows.W.shape[2]
    counted = rows.scales > 0.0
    size = np.sqrt(np.mean(rows.y**2, axis=0)) + 1e-300
    residual = rows.y
    for _ in range(2):
        weights = counted / size
        W = (rows.W * weights[:, :, None]).reshape(-1, p)
        theta = np.linalg.lstsq(W.T @ W, W.T @ (rows.y * weights).ravel(), rcond=1e-10)[0]
        residual = (rows.y - rows.W @ theta) * counted
        size = np.sqrt(np.sum(residual**2, axis=0) / np.maximum(counted.sum(axis=0), 1)) + 1e-300
    counts = counted.sum(axis=0)
    freedom = counts - p / joints
    if np.any(freedom < 0.5 * counts) or not counts.all():
        return None
    noise = np.sum(residual**2, axis=0) / freedom
    edges = np.cumsum([0, *(x.samples for x in window)])[:-1]
    sums = np.add.reduceat(residual, edges, axis=0)
    alike = np.sum(sums**2, axis=0) / np.maximum(np.sum(residual**2, axis=0), 1e-300)
    # The fit takes as many of the sums as it has parameters, at most half.
    alike *= len(window) / max(len(window) - p / joints, 0.5 * len(window))
    # Sums of neighbours are alike as well: as those of a noise of first order.
    pairs = np.sum(sums[1:] * sums[:-1], axis=0) / np.maximum(np.sum(sums**2, axis=0), 1e-300)
    follows = np.clip(pairs + 1.0 / len(window), 0.0, MOST)
    return noise, np.maximum(alike, 1.0) * (1.0 + follows) / (1.0 - follows)
