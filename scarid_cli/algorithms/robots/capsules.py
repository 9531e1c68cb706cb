"""The capsules of a robot's links: spheres, and spheres swept along a segment.

They are read from the <collision> elements of a URDF, where a cylinder stands for the capsule
around it, and from [[capsule]] tables of a description.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import cos, sin
from typing import Any
from xml.etree import ElementTree

import numpy as np

from scarid_cli.algorithms.keys import values
from scarid_cli.algorithms.robots.files import text_of
from scarid_cli.arrays import Array

KEYS = ("link", "from", "to", "radius")


@dataclass(frozen=True)
class Capsule:
    """All points within `radius` [m] of the segment from `start` to `end`, in the frame of a link.

    `link` is the name of the link in the URDF. If both ends are equal, it is a sphere.
    """

    link: str
    start: tuple[float, ...]
    end: tuple[float, ...]
    radius: float


def capsules_of(path: str) -> Iterator[Capsule]:
    """The spheres, cylinders and capsules of a URDF; boxes and meshes are left out."""
    for own in ElementTree.fromstring(text_of(path)).findall("link"):
        for collision in own.findall("collision"):
            for shape in collision.findall("geometry/*"):
                if shape.tag in ("sphere", "cylinder", "capsule"):
                    half = 0.5 * float(shape.get("length", "0"))
                    place, turn = _origin(collision.find("origin"))
                    ends = (place - half * turn[:, 2], place + half * turn[:, 2])
                    start, end = (tuple(map(float, x)) for x in ends)
                    yield Capsule(own.get("name", ""), start, end, float(shape.get("radius", "0")))


def capsule_of(entry: Mapping[str, Any]) -> Capsule:
    """The capsule of a [[capsule]] table; without `to` it is a sphere."""
    values.only("[[capsule]]", dict(entry), KEYS)
    start = values.row("from", entry["from"], 3)
    end = values.row("to", entry.get("to", entry["from"]), 3)
    radius = values.number("radius", entry["radius"])
    if not radius > 0.0:
        raise ValueError("the radius of a [[capsule]] is not positive")
    return Capsule(values.text("link", entry["link"]), start, end, radius)


def _origin(element: ElementTree.Element | None) -> tuple[Array, Array]:
    """The origin and rotation of an <origin>, whose rpy are angles about fixed x, y and z."""
    given = {} if element is None else element.attrib
    x, y, z = (float(value) for value in given.get("xyz", "0 0 0").split())
    roll, pitch, yaw = (float(value) for value in given.get("rpy", "0 0 0").split())
    cr, sr, cp, sp, cy, sy = (f(a) for a in (roll, pitch, yaw) for f in (cos, sin))
    turn = [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
    return np.array([x, y, z]), np.array(turn)
