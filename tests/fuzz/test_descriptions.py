"""Generated and mutated descriptions of robots: a robot, or an error of ours."""

from __future__ import annotations

import copy
import json
import tomllib
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from conftest import ROOT
from fuzz.support import NUMBERS, fuzzed, mutated, understood, written
from hypothesis import given
from hypothesis import strategies as st
from unit.arms import FINGERS, URDF

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.reading import ROBOTS, load
from scarid_cli.cli.robot import described

TEXTS = [path.read_text("utf-8") for path in sorted(ROBOTS.glob("*.toml"))]
TEXTS.append((ROOT / "samples" / "emps-asymmetric.toml").read_text("utf-8"))
DOCUMENTS = [tomllib.loads(text) for text in TEXTS]
PIECES = [b"'", b'"', b"[", b"]]", b"=", b"\n", b"#", b"{", b",", b"nan", b"inf", b"-1", b"1e308"]
WORDS = ["", "scara2", "revolute", "prismatic", "viscous", "q1", "\x1b", "\u202e", "a" * 300]
values = st.recursive(
    st.none().map(lambda _: False)
    | st.booleans()
    | st.integers(-(2**70), 2**70)
    | st.integers(-2, 9)
    | st.floats()
    | st.sampled_from(WORDS),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.sampled_from(WORDS), inner),
    max_leaves=6,
)


def checked(robot: Robot) -> None:
    """What is taken for a robot has torques, and can be described."""
    assert list(described(robot))
    if len(robot.joints) < 9:
        states = np.random.default_rng(0).uniform(-1.0, 1.0, (3, len(robot.joints), 4))
        with np.errstate(all="ignore"):  # of parameters near the largest number
            assert robot.regressor(*states).shape[2] == len(robot.parameters)


def read(content: bytes, suffix: str) -> None:
    with written(content, suffix) as path:
        understood(lambda: checked(load(path)))


@st.composite
def changed(draw: st.DrawFn) -> dict[str, Any]:
    """A description in which some values are others, are left out, or are there twice."""
    document = copy.deepcopy(draw(st.sampled_from(DOCUMENTS)))
    for _ in range(draw(st.integers(1, 3))):
        place: Any = document
        while True:
            keys = list(place) if isinstance(place, dict) else list(range(len(place)))
            if not keys:
                break
            key = draw(st.sampled_from(keys))
            deeper = isinstance(place[key], dict | list) and draw(st.integers(0, 3))
            if deeper:
                place = place[key]
                continue
            kind = draw(st.sampled_from(["other", "without", "twice"]))
            if kind == "other":
                place[key] = draw(values)
            elif kind == "without":
                del place[key]
            elif isinstance(place, list):
                place.append(copy.deepcopy(place[key]))
            break
    return document


def toml(document: dict[str, Any]) -> bytes:
    """The document, all of whose tables are inline."""
    return "".join(f"{_key(k)} = {_toml(v)}\n" for k, v in document.items()).encode()


def _key(key: str) -> str:
    return json.dumps(key)


def _toml(value: Any) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_key(k)} = {_toml(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_toml, value)) + "]"
    if isinstance(value, float):
        return repr(value)
    return json.dumps(value)


def test_the_tests_write_toml_as_tomllib_reads_it() -> None:
    for document in DOCUMENTS:
        assert tomllib.loads(toml(document).decode()) == document


@fuzzed()
@given(changed())
def test_a_changed_description_is_a_robot_or_refused(document: dict[str, Any]) -> None:
    read(toml(document), ".toml")


@fuzzed()
@given(st.sampled_from(TEXTS).flatmap(lambda text: mutated(text.encode(), PIECES)))
def test_a_damaged_description_is_a_robot_or_refused(content: bytes) -> None:
    read(content, ".toml")


ARM = URDF.replace("TYPE", "prismatic").replace("</robot>", f"{FINGERS}</robot>")
ATTRIBUTES = [*NUMBERS, "", "0 0 0", "1 0", "0 0 0 1", "one", "two", "fixed", "continuous", "mimic"]


@st.composite
def changed_arm(draw: st.DrawFn) -> bytes:
    """A URDF with other attributes, elements left out, repeated, or moved."""
    root = ElementTree.fromstring(ARM)
    for _ in range(draw(st.integers(1, 3))):
        parents = [e for e in root.iter() if len(e)]
        parent = draw(st.sampled_from(parents)) if parents else root
        if not len(parent):
            break
        child = draw(st.sampled_from(list(parent)))
        kind = draw(st.sampled_from(["attribute", "attribute", "without", "twice", "moved"]))
        if kind == "attribute":
            key = draw(st.sampled_from([*child.attrib, "name", "type"]))
            child.set(key, draw(st.sampled_from(ATTRIBUTES)))
        elif kind == "without":
            parent.remove(child)
        else:
            other = parent if kind == "twice" else draw(st.sampled_from(parents))
            other.append(copy.deepcopy(child))
    return ElementTree.tostring(root)


@fuzzed(0.5)
@given(changed_arm())
def test_a_changed_urdf_is_a_robot_or_refused(content: bytes) -> None:
    pytest.importorskip("pinocchio")
    read(content, ".urdf")


@fuzzed(0.5)
@given(mutated(ARM.encode(), [b"<", b">", b"/", b'"', b"&", b"0", b"<link/>", b"<joint/>"]))
def test_a_damaged_urdf_is_a_robot_or_refused(content: bytes) -> None:
    pytest.importorskip("pinocchio")
    read(content, ".urdf")


def test_the_tests_begin_with_robots() -> None:
    with written(ARM.encode(), ".urdf") as path:
        checked(load(path))
    assert Path(ROBOTS, "scara2.toml").read_text("utf-8") in TEXTS
