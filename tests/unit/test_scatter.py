"""The bandwidth at which identified parameters scatter least."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from scipy import signal
from stages.tables import SCARA

from scarid_cli.algorithms.tuning import lowpassed, scatter, spread
from scarid_cli.algorithms.tuning.lowpassed import Segment

H = 2e-3


def arm(
    seconds: float = 20.0,
    *,
    noise: float = 1e-5,
    vibration: float = 0.0,
    h: float = H,
    slower: float = 1.0,
) -> Segment:
    """A motion of two joints; a vibration [N m] of 15 Hz is in the torques and the positions."""
    t = np.arange(0.0, seconds, h)
    rng = np.random.default_rng(0)
    rates = np.array([[0.7, 1.9, 3.1], [1.1, 2.3, 4.3]]) / slower
    waves = np.exp(1j * (rates * t[:, None, None] + [0.0, 1.0, 2.0]))
    q, dq, ddq = (
        np.ascontiguousarray((waves * (1j * rates) ** n).imag.sum(axis=2).T) for n in range(3)
    )
    tau = SCARA.torques(SCARA.regressor(q, dq, ddq), SCARA.apriori)
    shaking = vibration * np.sin(
        2.0 * np.pi * 15.0 * t + np.cumsum(rng.standard_normal(len(t))) * 0.05
    )
    q = q + noise * rng.standard_normal(q.shape) + 1e-4 * shaking
    tau = tau + 0.02 * rng.standard_normal(tau.shape) + np.array([[1.0], [-0.1]]) * shaking
    return Segment(q, tau, np.full(2, noise))


def points(*values: float) -> list[scatter.Scatter]:
    return [scatter.Scatter(scatter.STEP**k, value, 1, 1.0) for k, value in enumerate(values)]


@pytest.mark.parametrize(
    ("values", "at", "ends"),
    [
        ((9, 1, 1.1, 1.2, 1.1, 1, 9), 3, (1, 5)),  # the middle of a plateau
        ((9, 1.4, 1.3, 1.4, 1.3, 9, 1, 1, 1, 1, 9), 2, (1, 4)),  # the lowest of two
        ((9, 1.2, 9, 1, 9, 9, 9), 3, (3, 3)),  # none is wide enough: the least
        ((1, 1, 1, 1), 1, (0, 3)),
        ((np.inf, 1, 1, 1, 1, 3), 2, (1, 4)),
    ],
)
def test_the_middle_of_the_lowest_plateau_is_chosen(
    values: Sequence[float], at: int, ends: tuple[int, int]
) -> None:
    choice = scatter.chosen(points(*values))
    assert choice.cutoff == pytest.approx(scatter.STEP**at)
    assert choice.plateau == pytest.approx([scatter.STEP**k for k in ends])


def test_the_creeping_before_a_motion_does_not_count() -> None:
    """It is faster than its noise, and as fast as anything so far."""
    own, creeping = arm(), 0.01 * np.arange(-500, 0) * H
    q = np.column_stack((own.q[:, :1] + creeping, own.q))
    tau = np.column_stack((np.zeros((2, 500)), own.tau))
    found = lowpassed.lowpassed(Segment(q, tau, np.zeros(2)), H, 10.0)
    assert found
    end = int(lowpassed.END / 10.0 / H) + lowpassed.REACH
    early = int((400 - end) * H / found.interval)  # until the low-pass knows of the motion
    assert early > 10
    assert not found.counts[:, :early].any()
    assert found.counts.mean() > 0.5


def test_vibration_lowers_the_cutoff() -> None:
    """The plateau ends below the vibration, which a likelihood would follow."""
    calm, shaken = (
        scatter.chosen(scatter.curve(SCARA, [arm(vibration=v)], H)) for v in (0.0, 20.0)
    )
    assert shaken.plateau[1] <= 15.0 < calm.plateau[1]


def test_the_search_ends_where_the_scatter_has_doubled() -> None:
    found = [point.scatter for point in scatter.curve(SCARA, [arm(noise=3e-4)], H)]
    least = np.minimum.accumulate(found)
    assert len(found) > scatter.FEWEST
    assert found[-1] > 2.0 * least[-1]
    assert np.all(np.array(found)[scatter.FEWEST : -1] <= 2.0 * least[scatter.FEWEST : -1])


@pytest.mark.parametrize("factor", [1.0, 4.0])
def test_the_first_cutoff_is_twice_the_bandwidth_of_the_motion(factor: float) -> None:
    """95 % of the power of these velocities lies below the fastest sine, 4.3 rad/s."""
    faster = arm(100.0)
    first = scatter.curve(SCARA, [faster], H / factor)[0].cutoff
    assert first == pytest.approx(factor * 2.0 * 4.3 / (2.0 * np.pi), rel=0.02)


def test_positions_in_steps_do_not_raise_the_first_cutoff() -> None:
    """A logger that reads the encoders at 20 Hz only."""
    smooth = arm(100.0)
    steps = np.repeat(smooth.q[:, ::25], 25, axis=1)[:, : smooth.q.shape[1]]
    stepped = Segment(steps, smooth.tau, smooth.noise)
    found, expected = (scatter.curve(SCARA, [x], H)[0].cutoff for x in (stepped, smooth))
    assert expected <= found < 2.0 * expected  # the steps have power at all multiples of 20 Hz


def test_noise_of_the_positions_lowers_the_cutoff() -> None:
    fine, coarse = (
        scatter.chosen(scatter.curve(SCARA, [arm(noise=x)], H)).cutoff for x in (1e-6, 3e-4)
    )
    assert coarse < fine


@pytest.mark.parametrize("slower", [2.0, 5.0])
@pytest.mark.parametrize("step", [2e-3, 1e-2])
def test_coarse_positions_of_slow_motions_do_not_bias(step: float, slower: float) -> None:
    """The estimate at the cut-off explains the torques of the true motion, nearly as the truth."""
    h = 1e-2
    true = arm(60.0, noise=0.0, h=h, slower=slower)
    q = np.round(true.q / step) * step
    coarse = Segment(q, true.tau, np.full(2, step / np.sqrt(12.0)))
    cutoff = scatter.chosen(scatter.curve(SCARA, [coarse], h)).cutoff
    part, clean = (lowpassed.lowpassed(x, h, cutoff) for x in (coarse, true))
    assert part
    assert clean
    W, C = (SCARA.regressor(*x.motion[:3])[x.counts.all(axis=0)] for x in (part, clean))
    tau = part.motion[3][:, part.counts.all(axis=0)].T
    found = np.linalg.lstsq(W.reshape(-1, W.shape[2]), tau.ravel(), rcond=None)[0]
    error, torque = C @ (found - SCARA.apriori), C @ SCARA.apriori
    assert np.all(error.std(axis=0) < 0.1 * torque.std(axis=0))


def test_the_bias_is_that_of_noise_in_the_rows() -> None:
    """Against the mean of estimates from regressors with noise drawn anew."""
    rng = np.random.default_rng(3)
    theta = np.array([2.0, -1.0])
    W = rng.standard_normal((4000, 1, 2)) * [1.0, 0.5]
    tau = (W @ theta).T + 0.1 * rng.standard_normal((1, 4000))
    counts = np.ones((1, 4000), dtype=bool)
    clean = scatter.Estimate(theta, np.eye(2), 1.0)
    shrunk = []
    for _ in range(20):
        N = 0.2 * rng.standard_normal(W.shape)
        sums, noises = (scatter.sums_of(x, tau, counts) for x in (W + N, N))
        rows = counts.sum(axis=1)
        variances = np.array([tau.var()])
        found = scatter._jackknife(sums, noises.sum(axis=0), rows, variances, clean)
        alone = scatter._jackknife(sums, 0.0 * noises.sum(axis=0), rows, variances, clean)
        shrunk.append((np.sum((found.theta - theta) ** 2), found.error - alone.error))
    true, said = np.mean(shrunk, axis=0)
    assert said == pytest.approx(true, rel=0.1)


def test_segments_count_together() -> None:
    """Two halves of a record choose nearly what the record chooses."""
    whole = arm()
    middle = whole.q.shape[1] // 2
    halves = [
        Segment(whole.q[:, part], whole.tau[:, part], whole.noise)
        for part in (slice(0, middle), slice(middle, None))
    ]
    one, two = (scatter.chosen(scatter.curve(SCARA, s, H)).cutoff for s in ([whole], halves))
    assert two == pytest.approx(one, rel=0.5)


def test_a_joint_that_stands_still_gives_no_choice() -> None:
    moving = arm()
    q = np.array([moving.q[0], np.zeros(moving.q.shape[1])])
    found = scatter.curve(SCARA, [Segment(q, moving.tau, moving.noise)], H)
    assert not any(np.isfinite(point.scatter) for point in found)


def test_the_jackknife_is_that_of_the_rows() -> None:
    """Against parameters identified anew without the rows of each part."""
    rng = np.random.default_rng(1)
    W, tau = rng.standard_normal((200, 1, 3)), rng.standard_normal((1, 200))
    counts = np.ones((1, 200), dtype=bool)
    sums = scatter.sums_of(W, tau, counts)
    still = np.zeros(sums.shape[1:])
    value = scatter._jackknife(sums, still, counts.sum(axis=1), np.array([tau.var()]), None).error
    thetas = []
    for k in range(scatter.PARTS):
        kept = np.arange(200) * scatter.PARTS // 200 != k
        thetas.append(np.linalg.lstsq(W[kept, 0], tau[0, kept], rcond=None)[0])
    off = np.array(thetas) - np.mean(thetas, axis=0)
    torques = W[:, 0] @ off.T
    expected = 19.0 / 20.0 * (torques**2).sum() / 200.0 / tau.var()
    assert value == pytest.approx(expected, rel=1e-9)


def test_the_lowpass_is_scipys() -> None:
    segment = arm(5.0)
    found = lowpassed.lowpassed(segment, H, 10.0)
    assert found is not None
    sections = signal.butter(4, 10.0, fs=1.0 / H, output="sos")
    expected = signal.sosfiltfilt(sections, segment.q, axis=1, padlen=int(3.0 / 10.0 / H))
    end = int(1.0 / 10.0 / H) + lowpassed.REACH
    step = max(1, int(1.0 / (10.0 * 10.0 * H)))
    inner = expected[:, end : expected.shape[1] - end][:, ::step]
    assert found.motion[0] == pytest.approx(inner, abs=1e-9)
    v = np.gradient(expected, H, axis=1)[:, end : expected.shape[1] - end][:, ::step]
    assert found.motion[1] == pytest.approx(v, abs=2e-3 * np.abs(v).max())


def test_blocks_choose_nearly_what_the_record_chooses(monkeypatch: pytest.MonkeyPatch) -> None:
    """Although their estimates scatter more: the scatter is that of the whole record."""
    long = arm(240.0)
    monkeypatch.setattr(spread, "ROWS", 1000)
    monkeypatch.setattr(spread, "PERIODS", 8.0)
    lowest = scatter.lowest(SCARA, [long], H)
    blocks, share = spread.spread([long], H, lowest)
    assert share < 0.5
    whole = scatter.chosen(scatter.curve(SCARA, [long], H)).cutoff
    of_blocks = scatter.chosen(scatter.curve(SCARA, blocks, H, share=share)).cutoff
    assert of_blocks == pytest.approx(whole, rel=0.5)
