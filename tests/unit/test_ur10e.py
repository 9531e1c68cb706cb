"""The description of the UR10e among the samples, against the manufacturer's published figures."""

from __future__ import annotations

from math import cos, pi, sin
from pathlib import Path

import numpy as np
import pytest

from scarid_cli.algorithms.robots.reading import load
from scarid_cli.algorithms.robots.terms import AxisTerm, StandardTerm

pinocchio = pytest.importorskip("pinocchio")

D = (0.1807, 0.0, 0.0, 0.17415, 0.11985, 0.11655)  # m
A = (0.0, -0.6127, -0.57155, 0.0, 0.0, 0.0)  # m
ALPHA = (pi / 2, 0.0, 0.0, pi / 2, -pi / 2, 0.0)  # rad
MASSES = (7.369, 13.051, 3.989, 2.1, 1.98, 0.615)  # kg
CENTRES = (  # m, in the Denavit-Hartenberg frames
    (0.021, 0.0, 0.027),
    (0.38, 0.0, 0.158),
    (0.24, 0.0, 0.068),
    (0.0, 0.007, 0.018),
    (0.0, 0.007, 0.018),
    (0.0, 0.0, -0.026),
)


def denavit_hartenberg(theta: float, d: float, a: float, alpha: float) -> np.ndarray:
    """The homogeneous matrix of one joint, in the standard convention."""
    c, s, ca, sa = cos(theta), sin(theta), cos(alpha), sin(alpha)
    return np.array(
        [[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1]]
    )


def places(q: np.ndarray) -> list[np.ndarray]:
    """The Denavit-Hartenberg frame of each link in that of the base."""
    found, place = [], np.eye(4)
    for joint in zip(q, D, A, ALPHA, strict=True):
        place = place @ denavit_hartenberg(*joint)
        found.append(place)
    return found


@pytest.mark.parametrize("seed", range(5))
def test_tool_and_centres_of_mass_are_where_the_published_parameters_put_them(
    seed: int, samples: Path
) -> None:
    robot = load(str(samples / "robots" / "ur10e.toml"))
    assert robot.body
    model = robot.body.model
    data = model.createData()
    q = np.random.default_rng(seed).uniform(-pi, pi, 6)
    pinocchio.framesForwardKinematics(model, data, q)
    expected = places(q)
    tool = data.oMf[model.getFrameId("tool")].homogeneous
    np.testing.assert_allclose(tool, expected[-1], atol=1e-12)
    for place, centre, found, inertia in zip(
        expected, CENTRES, list(data.oMi)[1:], list(model.inertias)[1:], strict=True
    ):
        own = found.act(inertia.lever)
        np.testing.assert_allclose(own, (place @ [*centre, 1.0])[:3], atol=1e-12)
    assert [inertia.mass for inertia in list(model.inertias)[1:]] == pytest.approx(MASSES)


def test_it_has_58_base_parameters(samples: Path) -> None:
    """36 of its links (two with the inertia of a motor), four motor inertias, 18 of friction."""
    robot = load(str(samples / "robots" / "ur10e.toml"))
    bodies = [p for p in robot.parameters if isinstance(p.term, StandardTerm)]
    axes = [p for p in robot.parameters if isinstance(p.term, AxisTerm)]
    assert (len(bodies), len(axes), len(robot.parameters)) == (36, 22, 58)


def test_its_links_can_exist(samples: Path) -> None:
    """Positive definite pseudo-inertias; the published ones are rounded."""
    robot = load(str(samples / "robots" / "ur10e.toml"))
    assert robot.body
    for inertia in list(robot.body.model.inertias)[1:]:
        J = inertia.toPseudoInertia().toMatrix()
        assert np.linalg.eigvalsh(J).min() > 0.0
