"""`scarid simulate --with`, the same in a description, and what is said about mistakes."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from conftest import Result, refused

from scarid_cli.algorithms.imperfections.registry import IMPERFECTIONS, written
from scarid_cli.algorithms.robots.reading import ROBOTS

Run = Callable[..., Result]


@pytest.fixture
def reference(scarid: Run, tmp_path: Path) -> Path:
    path = tmp_path / "reference.csv"
    assert scarid("trajgen", "-q", "--duration", 2, "-o", path).status == 0
    return path


@pytest.fixture
def simulate(scarid: Run, reference: Path) -> Run:
    """The log as text, with the true signals and the history left out."""
    return lambda *words: scarid("simulate", "--truth", *words, reference)


def test_the_help_has_a_line_for_every_imperfection(
    scarid: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "120")
    lines = scarid("simulate", "--help").out.splitlines()
    for name, kind in IMPERFECTIONS.items():
        (line,) = [line for line in lines if line.split()[:1] == [name]]
        assert line.endswith(kind.summary())
        assert kind.unit() in line


def test_imperfections_of_no_size_change_no_byte(simulate: Run) -> None:
    described = {"encoder-bits", "torque-noise"}  # replace values of the description
    names = [
        f"--with={written(name, kind.defaults(2)).partition(' ')[0]}"
        for name, kind in IMPERFECTIONS.items()
        if name not in described
    ]
    assert simulate(*names).out == simulate().out


@pytest.mark.parametrize(
    ("option", "name"),
    [
        ("--encoder-bits", "encoder-bits=12"),
        ("--position-noise", "position-noise=1e-4,2e-4"),
        ("--torque-noise", "torque-noise=0.5"),
    ],
)
def test_an_option_is_the_same_as_the_imperfection_of_its_name(
    option: str, name: str, simulate: Run
) -> None:
    found = simulate("--with", name)
    assert found.status == 0
    assert found.out != simulate().out
    assert simulate(option, name.partition("=")[2]).out == found.out
    refused(simulate("--with", name, option, 1), 2, f"{option}: {option[2:]} is given twice")


def description(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "mine.toml"
    path.write_text((ROBOTS / "scara2.toml").read_text("utf-8") + f"\n[imperfections]\n{text}\n")
    return path


def test_a_description_has_imperfections_and_with_replaces_them(
    simulate: Run, tmp_path: Path
) -> None:
    robot = description(tmp_path, "torque-delay = 0.002\nencoder-eccentricity = [1e-4, 2e-4]")
    ours = simulate("--with", "torque-delay=0.002", "--with", "encoder-eccentricity=1e-4,2e-4")
    assert simulate("--robot", robot).out == ours.out
    without = simulate("--robot", robot, "--with", "torque-delay=0")
    assert without.out == simulate("--with", "encoder-eccentricity=1e-4,2e-4").out


def test_robot_check_shows_the_imperfections(scarid: Run, tmp_path: Path) -> None:
    robot = description(tmp_path, "torque-delay = 0.002\nlost-rows = 0.01")
    lines = scarid("robot", "check", robot).out.splitlines()
    at = lines.index("imperfections of the simulated robot")
    assert lines[at + 1 : at + 3] == ["  torque-delay=0.002,0.002 s", "  lost-rows=0.01"]


@pytest.mark.parametrize(
    ("given", "reported"),
    [
        ("torque-delay", "--with torque-delay: write NAME=VALUE"),
        ("torque-dely=1", "there is no imperfection 'torque-dely'; did you mean torque-delay"),
        ("torque-delay=-1", "--with torque-delay=-1: -1 is outside its range; give 0 s or more"),
        ("torque-delay=nan", "nan is not a finite number"),
        ("torque-delay=inf", "inf is not a finite number"),
        ("torque-delay=soon", "'soon' is not a number"),
        ("torque-delay=1,2,3", "3 values; give one for all joints, or one for each of 2 joints"),
        ("lost-rows=1", "1 is outside its range; give a number from 0 to 0.9"),
        ("torque-outliers=0.1", "torque-outliers has no effect without torque-outlier-size"),
        ("encoder-side=both", "'both' is none of its words; give motor or link"),
        ("payload=1", "1 value; give 11 (mass, cx, cy, cz, Ixx, Ixy, Ixz, Iyy, Iyz, Izz, from)"),
        ("payload=-1,0,0,0,0,0,0,0,0,0,0", "mass -1 is outside its range; give 0 kg or more"),
        ("payload=1,0,0,0,1,0,0,1,0,9,0", "payload: no body has these moments of inertia"),
    ],
)
def test_a_mistake_is_reported_in_one_line(given: str, reported: str, simulate: Run) -> None:
    refused(simulate("--with", given), 2, reported)


def test_a_robot_that_cannot_have_an_imperfection_is_refused_before_anything_is_written(
    scarid: Run, samples: Path, tmp_path: Path
) -> None:
    arm, reference = samples / "arm.toml", tmp_path / "arm.csv"
    assert scarid("trajgen", "-q", "--robot", arm, "--duration", 2, "-o", reference).status == 0
    result = scarid("simulate", "--robot", arm, "--with", "flexibility=10", reference)
    refused(result, 2, "flexible joints with couplings cannot be simulated")


def test_a_mistake_in_a_description_is_reported_in_one_line(simulate: Run, tmp_path: Path) -> None:
    robot = description(tmp_path, "torque-delay = -1")
    refused(simulate("--robot", robot), 2, "mine.toml: not a robot description: [imperfections] to")


def test_lost_rows_and_jitter_are_for_resample(shell: Run) -> None:
    """The log of a bad clock is refused where a regular one is needed, and resample mends it."""
    made = shell(
        "scarid trajgen -q --duration 4 | scarid simulate --with lost-rows=0.01 "
        "--with sampling-jitter=2e-4 -o log.csv"
    )
    assert made.status == 0
    failed = shell("scarid differentiate log.csv -o motion.csv")
    refused(failed, 65, "put it on a constant rate with `scarid resample --rate ")
    mended = shell("scarid resample -q --rate 200 log.csv | scarid differentiate | scarid identify")
    assert mended.status == 0


CONDITIONS = {
    "clean": "encoder-bits=0 torque-noise=0",
    "coarse encoder": "encoder-bits=12",
    "noise x4": "torque-noise=0.8,0.04",
    "late torque": "torque-delay=0.02",
    "late by part of a sample": "torque-delay=0.0031",
    "offset": "torque-offset=1,0.1",
    "Stribeck": "stribeck=0.3,0.08 stribeck-velocity=0.1",
    "flexible joints": "flexibility=8,15",
    "flexible joints, encoders on the links": "flexibility=8 encoder-side=link",
    "vibrating base": "vibration=0.5 vibration-frequency=12",
    "coloured residuals": "coloured-torque-noise=0.4,0.02 torque-noise-time=0.1",
    "ripple": "ripple=0.5,0.02 ripple-cycles=16",
    "slow drive": "drive-bandwidth=40",
    "filtered torque": "torque-bandwidth=15",
    "outliers": "torque-outliers=0.01 torque-outlier-size=20,2",
    "lost and held rows": "lost-rows=0.01 repeated-rows=0.05",
    "standstill": "standstill-before=0.5 standstill-after=0.5",
    "load friction": "load-friction=0.1",
    "motor constant": "torque-constant-error=0.05",
    "weaker motor": "motor-gain=-0.05",
    "payload": "payload=1,0.1,0,0,0.01,0,0,0.01,0,0.01,1",
    "friction of a cold robot": "friction-drift=0.3 friction-drift-time=60",
    "asymmetric friction": "friction-asymmetry=0.2",
    "bad clock": "sampling-jitter=2e-4 stamp-jitter=1e-4",
}


@pytest.mark.parametrize("rate", [100, 1000])
@pytest.mark.parametrize("name", CONDITIONS)
def test_conditions_of_real_cells_can_be_expressed(name: str, rate: int, simulate: Run) -> None:
    words = [word for given in CONDITIONS[name].split() for word in ("--with", given)]
    found = simulate("--log-rate", rate, *words)
    assert found.status == 0
    assert found.out != simulate("--log-rate", rate).out


def test_torques_at_their_limits_are_told(scarid: Run, tmp_path: Path) -> None:
    """Of a description whose motor is too weak, for its share of the time; not of one that is not.

    The share is that of the rows whose measured torque is within its noise of the limit.
    """
    weak = tmp_path / "weak.toml"
    text = (ROBOTS / "scara2.toml").read_text("utf-8")
    weak.write_text(text.replace("[[joint]]", "[[joint]]\ntorque_limit = 8.0", 1))
    reference, log = tmp_path / "reference.csv", tmp_path / "log.csv"
    scarid("trajgen", "-q", "--robot", weak, "--seed", 2, "-o", reference)
    assert "limits" not in scarid("simulate", "--robot", "scara2", reference, "-o", log).err
    noiseless = ("--torque-noise", 0, "--log-rate", 1000, "--robot", weak)
    said = scarid("simulate", *noiseless, reference, "-o", log).err
    (share,) = re.findall(r"joint 1 in (\S+) % \(8 N m\): the motion is not followed there", said)
    torques = [float(line.split(",")[3]) for line in log.read_text().splitlines()[1:]]
    at_limit = sum(abs(torque) >= 8.0 - 1e-9 for torque in torques) / len(torques)
    assert float(share) == pytest.approx(100.0 * at_limit, abs=1.0)
    assert "joint 2 in" not in said
