"""What a motion will tell about the gains of the torques, or about a payload."""

from __future__ import annotations

import numpy as np

from scarid_cli.algorithms.changes import payload
from scarid_cli.algorithms.design.prediction import Moments, standard_errors
from scarid_cli.algorithms.inference.gains import KNOWN
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.physical import LENGTH, standard_of
from scarid_cli.algorithms.robots.rigid import Frame
from scarid_cli.arrays import Array
from scarid_cli.interval import HALF
from scarid_cli.stages.payload import frame_of
from scarid_cli.words import joints_named

RIDGE = 1e-12  # of the information of each parameter: what no motion tells has a large error
GROUPS = {"mass": [0], "centre": [1, 2, 3], "inertia": [4, 5, 6, 7, 8, 9]}


def gains(robot: Robot, moments: Moments, noise: Array) -> str:
    """How well the gains of the joints will be known beside that of the strongest one."""
    own = moments.of_joints / noise[:, None, None] ** 2
    theta = np.zeros(own.shape[1])  # a delay may be the last column
    theta[: len(robot.apriori)] = robot.apriori
    torques = own @ theta
    powers = torques @ theta
    information = np.block([[np.diag(powers), torques], [torques.T, own.sum(axis=0)]])
    one = int(np.argmax(powers))
    kept = np.delete(np.arange(len(information)), one)
    errors = standard_errors(information[np.ix_(kept, kept)])[: len(powers) - 1]
    others = [j + 1 for j in range(len(powers)) if j != one]
    told = [
        f"joint {j} +-{100.0 * HALF * error:.2g} %"
        for j, error in zip(others, errors, strict=True)
        if error < KNOWN
    ]
    untold = [j for j, error in zip(others, errors, strict=True) if not error < KNOWN]
    text = f"predicted for the torque gains beside joint {one + 1}: {', '.join(told) or 'none'}"
    return f"{text}; not told: {joints_named(untold)}" if untold else text


def load(robot: Robot, moments: Moments, noise: Array) -> str:
    """How well 1 kg at the tool will be known, if the bare robot moves alike."""
    frame, name = frame_of(robot, None, "a payload needs")
    information = moments.information(noise)
    information[np.diag_indices_from(information)] *= 1.0 + RIDGE
    count = len(robot.parameters)
    covariance = np.asarray(2.0 * np.linalg.inv(information)[:count, :count], dtype=np.float64)
    B = payload.directions(robot)
    found = payload.standard(B, np.zeros(count), covariance)
    _, errors = payload.located(_at(frame), found.covariance, frame)
    told = [
        f"{group} +-{HALF * np.max(errors[places]):.2g} {payload.UNITS[places[0]]}"
        for group, places in GROUPS.items()
        if np.isfinite(errors[places]).all()
    ]
    untold = [n for n, error in zip(payload.NAMES, errors, strict=True) if np.isnan(error)]
    text = f"predicted for 1 kg in the origin of {name}, and the bare robot moved alike: "
    text += ", ".join(told) or "nothing"
    return f"{text}; not told: {', '.join(untold)}" if untold else text


def _at(frame: Frame) -> Array:
    """The standard parameters (10) of 1 kg in the origin of a frame that is fixed to the link."""
    place = np.append(frame.origin / LENGTH, 1.0)
    return np.array(standard_of(np.outer(place, place), np.array))


PREDICTED = {"gains": gains, "payload": load}
