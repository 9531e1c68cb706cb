"""The payload of two identifications, against bodies that are known."""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pinocchio
import pyarrow as pa
import pytest
from cli.test_gates import document
from conftest import Shell, refused
from hypothesis import given, settings
from hypothesis import strategies as st
from unit.arms import seven_axes

from scarid_cli.algorithms.changes.carried import Piece, Sums
from scarid_cli.algorithms.changes.payload import Payload, Standard, directions, in_frame, standard
from scarid_cli.algorithms.robots.physical import inertia_of
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.algorithms.robots.rigid import PINOCCHIO, Frame
from scarid_cli.errors import BadData
from scarid_cli.io.table import Metadata, Table
from scarid_cli.stages.carried import Load
from scarid_cli.stages.carried import told as followed
from scarid_cli.stages.models.controllers import settings as settings_for
from scarid_cli.stages.payload import payload, table, told

AXES = 4


@pytest.fixture(scope="module")
def arm(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Four axes whose tool frame is turned and shifted."""
    flange = (
        '<link name="flange"/><joint name="tool" type="fixed"><parent link="l4"/>'
        '<child link="flange"/><origin xyz="0.1 0.02 0.3" rpy="0.4 -0.3 1.2"/></joint></robot>'
    )
    path = tmp_path_factory.mktemp("arm") / "arm.urdf"
    path.write_text(seven_axes(axes=AXES).replace("</robot>", flange))
    return path


PLACE = st.floats(-0.2, 0.2)


@settings(max_examples=20)
@given(st.floats(0.1, 5.0), st.tuples(PLACE, PLACE, PLACE), st.integers(0, 1 << 16))
def test_mass_centre_and_inertia_come_back(
    mass: float, centre: tuple[float, float, float], seed: int
) -> None:
    """Pinocchio moves the body from its frame to that of the axis."""
    rng = np.random.default_rng(seed)
    turn, _ = np.linalg.qr(rng.standard_normal((3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    origin = rng.uniform(-0.3, 0.3, 3)
    half = rng.standard_normal((3, 3))
    about = 0.01 * (half @ half.T + np.eye(3))
    body = pinocchio.Inertia(mass, np.array(centre), about)
    moved = pinocchio.SE3(turn, origin).act(body)
    phi = moved.toDynamicParameters()[PINOCCHIO]
    found = in_frame(Standard(phi, 1e-8 * np.eye(10), 1e4 * np.eye(10)), Frame(7, turn, origin))
    wanted = [mass, *centre, *(about[i, j] for i in range(3) for j in range(i, 3))]
    np.testing.assert_allclose(found.values, wanted, atol=1e-9)
    assert np.isfinite(found.errors).all()
    moments = np.linalg.eigvalsh(about)
    assert found.possible == (moments[2] < moments[0] + moments[1])
    least, middle, most = np.linalg.eigvalsh(inertia_of(found.body[4:]))
    assert most <= (least + middle) * (1.0 + 1e-9)


def test_the_difference_of_base_parameters_tells_all_ten(arm: Path) -> None:
    robot = load(str(arm))
    B = directions(robot)
    phi = np.array([0.03, 0.001, -0.002, 0.02, 0.003, 0.025, 0.05, -0.02, 0.1, 1.5])
    covariance = np.diag(np.linspace(1e-6, 1e-4, len(B)))
    found = standard(B, B @ phi, covariance)
    np.testing.assert_allclose(found.phi, phi, rtol=1e-9, atol=1e-12)
    rows = np.any(B != 0.0, axis=1)
    wanted = np.linalg.inv(B[rows].T @ np.linalg.inv(covariance[np.ix_(rows, rows)]) @ B[rows])
    np.testing.assert_allclose(found.covariance, wanted, rtol=1e-6, atol=1e-15)
    np.testing.assert_allclose(
        np.linalg.inv(found.factor.T @ found.factor), wanted, rtol=1e-6, atol=1e-15
    )


def test_of_a_wrist_whose_axes_meet_the_moments_are_told(tmp_path: Path) -> None:
    """In one point, against which no mass has a lever; its moments are known as they are."""
    links = "".join(
        f'<link name="l{k}"><inertial><origin xyz="0.01 0.02 0.03"/><mass value="1"/><inertia '
        f'ixx="0.01" iyy="0.012" izz="0.015" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        f'<joint name="j{k}" type="revolute"><parent link="{f"l{k - 1}" if k > 1 else "base"}"/>'
        f'<child link="l{k}"/><origin rpy="{turn} 0 0"/><axis xyz="0 0 1"/>'
        f'<limit lower="-3" upper="3" effort="9" velocity="3"/></joint>'
        for k, turn in ((1, 0.4), (2, 1.5708), (3, -1.5708))
    )
    path = tmp_path / "wrist.urdf"
    path.write_text(f'<robot name="wrist"><link name="base"/>{links}</robot>')
    robot = load(str(path))
    phi = np.array([1e-3, 0, 0, 1e-3, 0, 1e-3, 0.0075, 0.005, 0.0125, 0.25])
    known = 1e-10 * np.eye(len(robot.parameters))
    bare = SimpleNamespace(robot=robot, full=robot.apriori, covariance=known)
    loaded = SimpleNamespace(
        robot=robot, full=robot.apriori + directions(robot) @ phi, covariance=known
    )
    told = r"x 0\.0075 .* kg m, y 0\.005 .* kg m, z 0\.0125 .* kg m"
    with pytest.raises(BadData, match=told):
        payload(cast("Any", bare), cast("Any", loaded), None)
    with pytest.raises(BadData, match="both identifications are the same"):
        payload(cast("Any", bare), cast("Any", bare), None)


def test_a_change_that_is_taken_back_says_so() -> None:
    none = Sums.none(np.ones(10), 1)
    first = Piece(37.27, 60.0, 39.27, 90, [none])
    loads = [Load(np.array([mass, 0.0, 0.0, 0.0]), np.full(4, 0.01)) for mass in (0.0, 0.5)]
    plain = "picked up 0.5 +- 0.028 kg at 37.27 s (suspected at 39.27 s)"
    assert followed(first, *loads) == plain
    again = replace(first, misplaced=32.02)
    assert followed(again, *loads) == f"{plain}, not at 32.02 s as told before"


MADE = (
    "scarid trajgen -q --robot arm.toml --seed 5 --duration 15 -o ref.parquet;"
    " scarid simulate -q --robot arm.toml --seed 1 ref.parquet -o bare-log.parquet;"
    " scarid simulate -q --robot arm.toml --seed 2 ref.parquet -o loaded.parquet"
    " --with payload=1.2,0.03,-0.02,0.06,0.004,0,0,0.005,0,0.003,0;"
    " scarid identify -q bare-log.parquet -o bare.parquet"
)
JOINT = (
    "[[joint]]\nacceleration_limit = 9.0\nencoder_resolution = 1e-5\ntorque_noise = 0.05\n"
    "terms = { inertia = 0.1, viscous = 0.5, coulomb = 0.6, offset = 0.1 }\n"
)


def test_the_command_finds_what_the_simulator_hung_there(
    arm: Path, shell: Shell, tmp_path: Path
) -> None:
    (tmp_path / "arm.toml").write_text(f'title = "four"\nurdf = "{arm}"\n' + AXES * JOINT)
    made = shell(MADE)
    assert made.status == 0, made.err
    found = shell("scarid payload --parameters bare.parquet --frame l4 loaded.parquet")
    assert found.status == 0, found.err
    rows = {row["quantity"]: row for row in csv.DictReader(found.out.splitlines())}
    wanted = {"mass": 1.2, "x": 0.03, "y": -0.02, "z": 0.06, "Ixx": 0.004, "Ixy": 0.0, "Ixz": 0.0,
              "Iyy": 0.005, "Iyz": 0.0, "Izz": 0.003}  # fmt: skip
    outside = [
        name
        for name, value in wanted.items()
        if not float(rows[name]["low"]) <= value <= float(rows[name]["high"])
    ]
    assert len(outside) <= 1, outside
    assert float(rows["mass"]["estimate"]) == pytest.approx(1.2, rel=0.02)
    for name in "xyz":
        assert float(rows[name]["estimate"]) == pytest.approx(wanted[name], abs=0.005)
    same = shell(
        "scarid identify -q loaded.parquet -o p.parquet;"
        " scarid payload -q --parameters bare.parquet --frame l4 p.parquet"
    )
    assert same.out == found.out
    told = shell("scarid payload -q --json --parameters bare.parquet --frame l4 p.parquet")
    machine = document(told.out)
    assert [x["estimate"] for x in machine["values"]] == [
        float(row["estimate"]) for row in rows.values()
    ]
    assert machine["controllers"]["UR"] in found.err
    moments = np.linalg.eigvalsh(inertia_of(np.array([x["body"] for x in machine["values"]])[4:]))
    assert moments[0] > 0.0
    assert moments[2] < moments[0] + moments[1]
    assert machine["loaded"]["verdict"] in found.err
    less = document(shell("scarid payload -q --json --parameters p.parquet bare.parquet").out)
    assert less["controllers"] == {}
    assert less["away"] is None
    assert all(x["body"] is None for x in less["values"])
    page = shell(
        "scarid payload -q --parameters bare.parquet --frame l4 p.parquet -o payload.parquet;"
        " scarid report bare.parquet payload.parquet"
    )
    assert "in the frame of l4" in page.out
    assert f"{float(rows['mass']['estimate']):.4g}"[:4] in page.out
    wrong = shell("scarid payload --parameters bare.parquet --frame l2 p.parquet")
    refused(wrong, 2, "--frame l2: no link that is fixed to the last axis; it has l4, flange")


def test_a_payload_is_found_when_it_is_picked_up(arm: Path, shell: Shell, tmp_path: Path) -> None:
    """Live and from the log, with the same bits however the rows arrive."""
    (tmp_path / "arm.toml").write_text(f'title = "four"\nurdf = "{arm}"\n' + AXES * JOINT)
    made = shell(MADE.replace("15", "30").replace("0.003,0;", "0.003,18.3;"))
    assert made.status == 0, made.err
    command = "scarid payload --parameters bare.parquet --frame l4"
    found = shell(f"{command} --trace trace.csv loaded.parquet -o l.csv && scarid report l.csv")
    assert found.status == 0, found.err
    assert "Payloads over time" in found.out
    bare, heavy = csv.DictReader((tmp_path / "l.csv").read_text().splitlines())
    assert 18.0 <= float(heavy["t_start"]) <= 18.6
    assert float(heavy["t_found"]) <= 19.3
    assert abs(float(bare["load_mass"])) < 0.05
    assert bare["centre_x"] == ""
    assert float(heavy["load_mass"]) == pytest.approx(1.2, abs=0.03)
    for name, value in zip("xyz", (0.03, -0.02, 0.06), strict=True):
        assert float(heavy[f"centre_{name}"]) == pytest.approx(value, abs=0.005)
    assert "picked up 1." in found.err
    motion = "scarid differentiate -q --format arrow loaded.parquet"
    pipe = f"{motion} | {command} -q --trace piped.csv"
    together = f"{motion} then {command[7:]} -q --trace together.csv"
    assert shell(pipe).out == shell(together).out
    traces = [(tmp_path / f"{name}.csv").read_text() for name in ("piped", "together")]
    assert traces[0] == traces[1]
    changed = [row for row in csv.DictReader(traces[0].splitlines()) if float(row["load_changed"])]
    assert len(changed) == 1
    refused(shell(f"{command} --trace t.csv --json loaded.parquet"), 2, "--json is of one payload")
    short = shell(f"{motion} -o m.parquet; {command} --trace t.csv --rows 1:70 m.parquet")
    refused(short, 65, "less than 0.5 s of settled rows")


def test_a_robot_without_a_urdf_has_no_flange(shell: Shell) -> None:
    done = shell(
        "scarid identify -q --robot scara2 $SAMPLES/scara2.csv -o p.parquet;"
        " scarid payload --parameters p.parquet p.parquet"
    )
    refused(done, 2, "scara2: a payload needs a robot with a URDF")


def test_the_bare_robot_twice_has_no_payload(arm: Path, shell: Shell, tmp_path: Path) -> None:
    (tmp_path / "arm.toml").write_text(f'title = "four"\nurdf = "{arm}"\n' + AXES * JOINT)
    made = shell(
        "export SCARID_ROBOT=arm.toml; scarid trajgen -q --seed 5 --duration 8 |"
        " scarid simulate -q | scarid identify -q -o bare.parquet"
    )
    assert made.status == 0, made.err
    done = shell("scarid payload --parameters bare.parquet bare.parquet")
    refused(done, 65, "both identifications are the same; give a log with the payload")


def hung(mass: float, error: float, inertia: float = 0.02) -> Payload:
    """A body of this mass, known within so much, of which the inertia has an error of .01."""
    phi = np.array([inertia, 0.0, 0.0, inertia, 0.0, inertia, 0.0, 0.0, 0.1 * mass, mass])
    phi[[0, 3]] += 0.01 * abs(mass)
    errors = np.array([*[0.01] * 6, *[0.001] * 3, error])
    found = Standard(phi, np.diag(errors**2), np.diag(1.0 / errors))
    return in_frame(found, Frame(7, np.eye(3), np.zeros(3)))


@pytest.mark.parametrize("mass", [0.02, -0.02])
def test_nothing_that_hangs_there_has_neither_a_centre_nor_settings(mass: float) -> None:
    found = hung(mass, 0.02)
    assert np.isnan(found.errors[1:]).all()
    (line,) = told(found, "tool")
    half = "0.039"
    assert line == f"nothing more than the bare robot has hangs on tool: mass {mass:g} +- {half} kg"


def test_less_than_the_bare_robot_has_is_no_body() -> None:
    found = hung(-0.5, 0.02)
    assert np.isnan(found.body).all()
    assert settings_for(found.told, found.values - 2.0 * found.errors) == {}
    (line,) = told(found, "tool")
    assert line.startswith("0.5 +- 0.039 kg less than the bare robot has hangs on tool: give ")


@pytest.mark.parametrize(("inertia", "lists"), [(0.1, 2), (0.015, 1)])
def test_an_inertia_that_may_be_0_is_not_in_the_settings(inertia: float, lists: int) -> None:
    settings_of = [x for x in told(hung(2.0, 0.02, inertia), "tool") if x.startswith("for UR")]
    assert settings_of[0].count("[") == lists


def test_what_a_motion_does_not_tell_has_no_value() -> None:
    errors = np.array([0.1, 0.1, np.nan, 0.1, *[np.nan] * 6])
    found = Payload(np.arange(1.0, 11.0), errors, body=np.ones(10), away=0.0)
    bare = Table("bare", pa.schema([]), Metadata(kind="parameters"), iter(()))
    (batch,) = table(found, bare, "tool").batches
    known = ~np.isnan(errors)
    for name in ("estimate", "robust_error", "low", "high"):
        assert [x is not None for x in batch[name].to_pylist()] == known.tolist()
