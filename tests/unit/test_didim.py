"""Direct and inverse identification: torques and the reference are enough."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from conftest import seeds
from unit.plants import GAINS, closed_loop

from scarid_cli.algorithms.estimators import didim
from scarid_cli.algorithms.excitations.quintic import Excitation
from scarid_cli.algorithms.regression.rows import Rows, rows_of
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.algorithms.trajectories.limits import Limits
from scarid_cli.algorithms.uncertainty.jackknife import jackknife
from scarid_cli.errors import UsageFault

SCARA = load("scara2")
H, RATIO = 0.005, 5  # s; periods of the controller in one of the log


def experiment(seed: int) -> Rows:
    """The torques of the SCARA that follows a random reference, and nothing else of its log."""
    limits = Limits.of(SCARA.joints)
    rng = np.random.default_rng(seed)
    path = Excitation().trajectory(limits, limits.home, 20.0, rng)
    reference = np.array(path.sample(np.arange(20 * RATIO * 200) * H / RATIO))
    settings = {
        "encoder_resolution": np.array([joint.encoder_resolution for joint in SCARA.joints]),
        "torque_noise": np.array([joint.torque_noise for joint in SCARA.joints]),
        "velocity_cutoff": 20.0,
        "seed": seed,
    }
    loop = closed_loop(SCARA, **GAINS, **settings)
    log = loop.step(loop.init(reference[0, :, 0]), *reference)[1]
    kept = reference[:, :, ::RATIO]
    motion = np.concatenate((kept, log.tau[None, :, ::RATIO]))
    return rows_of(SCARA, motion, np.arange(kept.shape[2]), H, reference=kept[:2])


def with_apriori_off_by(factor: float) -> Robot:
    parameters = (replace(p, apriori=factor * p.apriori) for p in SCARA.parameters)
    return replace(SCARA, parameters=tuple(parameters))


def test_didim_finds_the_parameters_of_the_simulated_robot_without_its_positions() -> None:
    """Whatever is known a priori; deviations in standard errors have a root mean square of 1."""
    solver = didim.Estimator().for_robot(with_apriori_off_by(2.0))
    deviations = []
    for seed in seeds(5, 10):
        found = solver.fit([experiment(seed)])
        assert found.scores is not None
        assert found.scores.rows is not None
        errors = jackknife(found.scores.rows, found).errors
        deviations.append((found.fit.estimates - SCARA.apriori) / errors)
    assert np.abs(deviations).max() < 4.0
    assert 0.7 < np.sqrt(np.mean(np.square(deviations))) < 1.3


@pytest.mark.parametrize(
    ("kp", "kd", "complaint"),
    [
        ((6.5, 155.0), (5.0, 25.0), "not positive definite"),  # the gains printed in the paper
        ((800.0, 25.0), (1.0, 0.025), "does not converge"),
        ((8e5, 25e3), (1e4, 250.0), "becomes unstable"),
    ],
)
def test_didim_is_refused_for_a_robot_that_another_controller_moved(
    kp: tuple[float, ...], kd: tuple[float, ...], complaint: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(didim, "ITERATIONS", 5)  # to be quick: twenty do not converge either
    assert SCARA.control is not None
    robot = replace(SCARA, control=replace(SCARA.control, kp=kp, kd=kd))
    with pytest.raises(UsageFault, match=f"{complaint}.*control"):
        didim.Estimator().for_robot(robot).fit([experiment(1)])
