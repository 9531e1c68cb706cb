"""Where links are and how far apart, against Pinocchio and coal; gradients against differences."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from unit.arms import URDF, described_arm

from scarid_cli.algorithms.robots.capsules import Capsule, capsules_of
from scarid_cli.algorithms.robots.clearance import Clearance, closest, inside
from scarid_cli.algorithms.robots.pose import Points, Pose, Pullback
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.algorithms.robots.rigid import Body
from scarid_cli.cli.robot import described
from scarid_cli.errors import UsageFault

pinocchio = pytest.importorskip("pinocchio")
coal = pytest.importorskip("coal")

SAMPLES = 7

# Six axes of any direction, two of them prismatic; each link carries a shape.
SHAPES = (
    '<sphere radius="0.05"/>',
    '<cylinder radius="0.04" length="0.3"/>',
    '<capsule radius="0.03" length="0.2"/>',
)


def winding_arm() -> str:
    rng = np.random.default_rng(0)
    parts = ['<robot name="winding"><link name="l0"/>']
    for i in range(1, 7):
        axis = rng.standard_normal(3)
        numbers = [*rng.uniform(-0.3, 0.3, 3), *rng.uniform(-3, 3, 3), *axis / np.linalg.norm(axis)]
        x, y, z, a, b, c, *direction = (f"{number:.9f}" for number in numbers)
        kind = "prismatic" if i in (2, 5) else "revolute"
        parts.append(
            f'<joint name="j{i}" type="{kind}"><parent link="l{i - 1}"/><child link="l{i}"/>'
            f'<origin xyz="{x} {y} {z}" rpy="{a} {b} {c}"/><axis xyz="{" ".join(direction)}"/>'
            '<limit lower="-3" upper="3" effort="9" velocity="9"/></joint>'
            f'<link name="l{i}"><collision><origin xyz="{y} {z} {x}" rpy="{c} {a} {b}"/>'
            f"<geometry>{SHAPES[i % 3]}</geometry></collision></link>"
        )
    tool = '<joint name="f" type="fixed"><parent link="l6"/><child link="tool"/>'
    return "".join([*parts, tool, '<origin xyz="0.1 0.2 0.3"/></joint><link name="tool"/></robot>'])


@pytest.fixture
def body(tmp_path: Path) -> Body:
    path = tmp_path / "winding.urdf"
    path.write_text(winding_arm())
    found = load(str(path)).body
    assert found
    return found


def positions(body: Body) -> np.ndarray:
    return np.random.default_rng(1).uniform(-2.0, 2.0, (6, SAMPLES))


def frames(body: Body, q: np.ndarray) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Rotation and origin of each link, by Pinocchio."""
    data = body.model.createData()
    pinocchio.framesForwardKinematics(body.model, data, q)
    places = {f.name: data.oMf[i] for i, f in enumerate(body.model.frames)}
    return {name: (x.rotation.copy(), x.translation.copy()) for name, x in places.items()}


def slopes(
    of: Callable[[Pose], tuple[np.ndarray, Pullback]], body: Body, q: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The pullback of random weights, and the same by central differences."""
    value, pullback = of(Pose.of(body.axes, q))
    weights = np.random.default_rng(2).standard_normal(value.shape)
    numeric = np.empty_like(q)
    for i in range(len(q)):
        h = np.zeros_like(q)
        h[i] = 1e-6
        up, down = (of(Pose.of(body.axes, q + s * h))[0] for s in (1.0, -1.0))
        change = np.moveaxis(weights * (up - down) / 2e-6, value.shape.index(SAMPLES), 0)
        numeric[i] = change.reshape(SAMPLES, -1).sum(axis=1)
    return pullback(weights), numeric


def test_the_tool_is_where_pinocchio_puts_it(body: Body) -> None:
    assert body.tool == "tool"
    q = positions(body)
    X, _ = Pose.of(body.axes, q).positions(body.points(body.tool, [[0, 0, 0], [0.1, -0.2, 0.3]]))
    for k in range(SAMPLES):
        turn, origin = frames(body, q[:, k])["tool"]
        np.testing.assert_allclose(X[0, k], origin, atol=1e-12)
        np.testing.assert_allclose(X[1, k], origin + turn @ [0.1, -0.2, 0.3], atol=1e-12)


def test_the_gradient_of_points_is_that_of_differences(body: Body) -> None:
    """Of points on all links and on the base."""
    places = np.random.default_rng(3).standard_normal((9, 3))
    points = Points(np.array([0, 1, 2, 3, 4, 5, 6, 6, 2]), places)
    found, expected = slopes(lambda pose: pose.positions(points), body, positions(body))
    np.testing.assert_allclose(found, expected, atol=1e-7 * np.abs(expected).max())


def test_the_gradient_of_the_distance_to_the_walls_is_that_of_differences(body: Body) -> None:
    points = body.points(body.tool)

    def of(pose: Pose) -> tuple[np.ndarray, Pullback]:
        return inside(points, pose, [-0.3, -0.2, 0.0], [0.4, 0.5, 1.0])

    distances, _ = of(Pose.of(body.axes, positions(body)))
    X, _ = Pose.of(body.axes, positions(body)).positions(points)
    np.testing.assert_allclose(distances[2], X[..., 2])
    np.testing.assert_allclose(distances[3], 0.4 - X[..., 0])
    found, expected = slopes(of, body, positions(body))
    np.testing.assert_allclose(found, expected, atol=1e-7 * np.abs(expected).max())


def test_distances_between_links_are_those_of_coal(body: Body) -> None:
    clearance = Clearance.of(body)
    assert len(clearance.pairs) == 10
    assert clearance.names[0] == "l1 and l3"
    q = positions(body)
    distances, _ = clearance.distances(Pose.of(body.axes, q))
    for k in range(SAMPLES):
        shapes = [placed(capsule, frames(body, q[:, k])[capsule.link]) for capsule in body.capsules]
        for pair, distance in zip(clearance.pairs, distances[:, k], strict=True):
            expected = separation(*(shapes[number] for number in pair))
            assert distance == pytest.approx(expected, abs=1e-6)
    assert distances.min() < 0.0 < distances.max(), "some overlap, some do not"


def placed(capsule: Capsule, place: tuple[np.ndarray, np.ndarray]) -> tuple[object, object]:
    """A capsule of coal (along z, about its middle) and where it is."""
    turn, origin = place
    start, end = (origin + turn @ np.array(x) for x in (capsule.start, capsule.end))
    length = float(np.linalg.norm(end - start))
    z = (end - start) / length if length else np.array([0.0, 0.0, 1.0])
    x = np.cross(z, [1.0, 0.0, 0.0] if abs(z[0]) < 0.9 else [0.0, 1.0, 0.0])
    x /= np.linalg.norm(x)
    about = np.column_stack((x, np.cross(z, x), z))
    return coal.Capsule(capsule.radius, length), coal.Transform3s(about, (start + end) / 2.0)


def separation(one: tuple[object, object], two: tuple[object, object]) -> float:
    result = coal.DistanceResult()
    return float(coal.distance(*one, *two, coal.DistanceRequest(), result))


def test_the_gradient_of_distances_is_that_of_differences(body: Body) -> None:
    clearance = Clearance.of(body)
    found, expected = slopes(clearance.distances, body, positions(body))
    np.testing.assert_allclose(found, expected, atol=1e-6 * np.abs(expected).max())


@pytest.mark.parametrize(
    ("segments", "distance"),
    [
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], 1.0),
        ([[0, 0, 0], [1, 0, 0], [3, 0, 0], [4, 0, 0]], 2.0),
        ([[0, 0, 0], [1, 0, 0], [4, 4, 0], [9, 4, 0]], 5.0),
        ([[0, 0, 0], [1, 0, 0], [0.5, -1, 2], [0.5, 1, 2]], 2.0),
        ([[0, 0, 0], [1, 0, 0], [0.5, -1, 0], [0.5, 1, 0]], 0.0),
        ([[0, 0, 0], [0, 0, 0], [3, 4, 0], [3, 9, 0]], 5.0),
        ([[3, 4, 0], [3, 9, 0], [0, 0, 0], [0, 0, 0]], 5.0),
        ([[1, 1, 1], [1, 1, 1], [1, 1, 4], [1, 1, 4]], 3.0),
        ([[0, 0, 0], [1, 0, 0], [1, 0, 0], [2, 1e-7, 0]], 0.0),
    ],
    ids=[
        "beside",
        "ahead",
        "parallel",
        "crossed",
        "crossing",
        "point",
        "to-point",
        "points",
        "almost-parallel",
    ],
)
def test_segments_in_special_positions(segments: list[list[float]], distance: float) -> None:
    p1, q1, p2, q2 = np.array(segments, dtype=float)
    s, t = closest(p1, q1, p2, q2)
    apart = (1 - s) * p1 + s * q1 - (1 - t) * p2 - t * q2
    assert np.linalg.norm(apart) == pytest.approx(distance, abs=1e-6)


def test_capsules_of_a_description_come_beside_those_of_the_urdf(tmp_path: Path) -> None:
    urdf = tmp_path / "two.urdf"
    urdf.write_text(URDF.replace("TYPE", "revolute"))
    lines = (
        "[[capsule]]\nlink = 'base'\nfrom = [0.0, 0.0, -0.5]\nradius = 0.1\n"
        "[[capsule]]\nlink = 'two'\nfrom = [0.0, 0.0, 0.0]\nto = [0.4, 0.0, 0.0]\nradius = 0.05\n"
    )
    robot = described_arm(str(urdf), tmp_path, lines)
    body = robot.body
    assert body
    assert not list(capsules_of(str(urdf)))
    shown = list(described(robot))
    at = shown.index("shapes of the links")
    assert shown[at + 1 : at + 3] == [
        "  base: sphere at 0 0 -0.5 m, radius 0.1 m",
        "  two: capsule from 0 0 0 to 0.4 0 0 m, radius 0.05 m",
    ]
    assert f"tool        {body.tool}" in shown
    clearance = Clearance.of(body)
    assert clearance.names == ("base and two",)
    q = np.array([[0.5 * np.pi], [0.0]])  # the arm hangs down; its tip at z = 0.1 - 0.7
    distances, _ = clearance.distances(Pose.of(body.axes, q))
    assert distances[0, 0] == pytest.approx(-0.15)  # the sphere's centre is on the segment


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ("link = 'no'\nfrom = [0.0, 0.0, 0.0]\nradius = 1.0", "'no'; choose base or one or two"),
        ("link = 'one'\nfrom = [0.0, 0.0]\nradius = 1.0", "not a list of 3 numbers"),
        ("link = 'one'\nfrom = [0.0, 0.0, 0.0]\nradius = 0.0", "radius of a .* is not positive"),
        ("link = 'one'\nradius = 1.0", "missing 'from'"),
    ],
)
def test_a_capsule_that_makes_no_sense_is_refused(lines: str, message: str, tmp_path: Path) -> None:
    urdf = tmp_path / "two.urdf"
    urdf.write_text(URDF.replace("TYPE", "revolute"))
    with pytest.raises(UsageFault, match=message):
        described_arm(str(urdf), tmp_path, f"[[capsule]]\n{lines}")
