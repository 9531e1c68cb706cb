"""The command trajgen: motions within the limits of a robot, from home to home."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Mapping
from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pytest
from conftest import Result, refused

from scarid_cli.cli.actions.trajgen import _require_moderate
from scarid_cli.errors import UsageFault

Run = Callable[..., Result]
Shell = Callable[..., Result]

# Two axes of the kind that cannot be at zero: an elbow that bends one way only.
ELBOW = """title = "elbow"
[[joint]]
type = "revolute"
position_limit = 1.0
velocity_limit = 2.0
acceleration_limit = 10.0
[[joint]]
type = "revolute"
position_limit = [-3.07, -0.07]
velocity_limit = 2.0
acceleration_limit = 10.0
"""
PARAMETER = (
    '[[parameter]]\nname = "I{i}"\nterm = "mass"\njoint = {i}\nunit = "kg m2"\napriori = 1\n'
)


@pytest.fixture
def elbow(tmp_path: Path) -> Path:
    path = tmp_path / "elbow.toml"
    path.write_text(ELBOW + "".join(PARAMETER.format(i=i) for i in (1, 2)))
    return path


@pytest.mark.parametrize(("times", "accepted"), [(1, True), (2, False)])
def test_as_many_rows_as_can_be_written_are_accepted(times: int, *, accepted: bool) -> None:
    with nullcontext() if accepted else pytest.raises(UsageFault, match=r"more than 1e\+09 rows"):
        _require_moderate(1e3, 1e6, times)


def columns(table: str) -> Mapping[str, np.ndarray]:
    rows = list(csv.reader(io.StringIO(table)))
    values = np.array(rows[1:], dtype=float).T
    return dict(zip(rows[0], values, strict=True))


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("excitation", ["quintic", "sequential"])
def test_a_motion_stays_between_both_limits_and_starts_at_home(
    seed: int, excitation: str, elbow: Path, scarid: Run
) -> None:
    motion = columns(
        scarid("trajgen", "--robot", elbow, "--seed", seed, "--excitation", excitation).out
    )
    first, second = motion["q1_ref"], motion["q2_ref"]
    assert np.all(np.abs(first) <= 1.0)
    assert np.all((second >= -3.07) & (second <= -0.07))
    assert np.ptp(second) > 0.5
    home = (-3.07 - 0.07) / 2.0
    assert (first[0], first[-1]) == (0.0, 0.0)
    assert (second[0], second[-1]) == pytest.approx((home, home), abs=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_a_panda_is_not_driven_beyond_its_limits(seed: int, scarid: Run, real_logs: Path) -> None:
    """Joint 4 within -3.07 and -0.07, joint 6 within -0.02 and 3.75; fingers are no axes."""
    pytest.importorskip("pinocchio")
    urdf = real_logs / "urdf" / "panda.urdf"
    motion = columns(scarid("trajgen", "--robot", urdf, "--ddq-max", 5, "--seed", seed).out)
    assert [name for name in motion if name.startswith("q")] == [f"q{i}_ref" for i in range(1, 8)]
    assert np.all((motion["q4_ref"] >= -3.0718) & (motion["q4_ref"] <= -0.0698))
    assert np.all((motion["q6_ref"] >= -0.0175) & (motion["q6_ref"] <= 3.7525))


def test_home_may_be_given(scarid: Run) -> None:
    motion = columns(scarid("trajgen", "--duration", 4, "--home", "0.3,-0.4").out)
    ends = [motion[f"q{i}_ref"][[0, -1]].tolist() for i in (1, 2)]
    assert ends == [pytest.approx([0.3, 0.3]), pytest.approx([-0.4, -0.4])]


def test_limits_may_be_given_as_an_interval(scarid: Run) -> None:
    words = ("--duration", 10, "--q-min", "0.1,-1.4", "--q-max", "0.5,-1", "--seed", 3)
    motion = columns(scarid("trajgen", *words).out)
    for name, low, high in (("q1_ref", 0.1, 0.5), ("q2_ref", -1.4, -1.0)):
        assert low <= motion[name].min() < motion[name].max() <= high
        assert motion[name][0] == pytest.approx((low + high) / 2.0)


@pytest.mark.parametrize(
    "words", [("--q-max", "0.5"), ("--q-max", "9", "--dq-max", "99"), ("--q-min", "-9")]
)
def test_options_never_widen_the_limits_of_the_description(
    words: tuple[str, ...], elbow: Path, scarid: Run
) -> None:
    """Joint 2 within -3.07 and -0.07: a bound of 0.5 on |q| must not drive it to +0.5."""
    result = scarid("trajgen", "--robot", elbow, *words)
    motion = columns(result.out)
    assert np.all((motion["q2_ref"] >= -3.07) & (motion["q2_ref"] <= -0.07))
    assert "joint" in result.err.splitlines()[0]
    assert "the description has narrower limits than given, and these hold" in result.err
    within = scarid("trajgen", "--robot", elbow, "--q-min", "-1", "--q-max", "1,-0.1")
    assert "narrower" not in within.err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            ("--home", "0"),
            "--home: joint 2 at 0 is outside its position limits, -3.07 to -0.07",
        ),
        (("--home", "0,nan"), "'--home': give a finite number, not nan"),
        (("--home", "0,-1,0"), "--home: 3 values for 2 joints; give 1 or 2"),
        (("--q-min", "-1,0"), "--q-min, --q-max: joint 2 has no position from 0 to -0.07"),
        (("--q-max", "-1"), "--q-max: the bounds must be positive and finite"),
        (("--q-max", "inf"), "'--q-max': give a finite number, not inf"),
        (("--q-max", "1", "--q-min=-inf"), "'--q-min': give a finite number, not -inf"),
        (("--set", "longest"), "--set longest: write NAME=VALUE"),
        (("--set", "longest=x"), "--set longest=x: 'x' is not a number"),
        (("--set", "harmonics=3"), "quintic has no setting 'harmonics'; it has shortest, longest"),
        (("--segment", "2", "1"), "give 0 < shortest <= longest"),
    ],
)
def test_what_cannot_be_generated_is_refused(
    words: tuple[str, ...], message: str, elbow: Path, scarid: Run
) -> None:
    refused(scarid("trajgen", "--robot", elbow, *words), 2, message)


@pytest.mark.parametrize(
    ("points", "home", "message"),
    [
        ("0,0,-1;2,0.5,-2;4,0,-1", "0,-1", ""),
        ("0,0,-1;2,0.5,-2;4,0,-1", "0,-2", "must start at the home position: joint 2 is at -1"),
        ("0,0,-1;2,0.5,-0.05;4,0,-1", "0,-1", "via point 2: joint 2 at -0.05 is outside"),
        ("0,0,-1;2,0.5,-2;4,0.1,-1", "0,-1", "must end at the home position: joint 1 is at 0.1"),
    ],
)
def test_via_points_start_and_end_at_home(
    points: str, home: str, message: str, elbow: Path, scarid: Run, tmp_path: Path
) -> None:
    via = tmp_path / "via.csv"
    via.write_text("t,q1,q2\n" + points.replace(";", "\n") + "\n")
    result = scarid("trajgen", "--robot", elbow, "--via", via, "--home", home)
    if message:
        refused(result, 2, message)
    else:
        assert result.status == 0
        assert columns(result.out)["q2_ref"][0] == -1.0


def test_a_table_without_via_points_is_refused(scarid: Run, tmp_path: Path) -> None:
    via = tmp_path / "via.csv"
    via.write_text("t,q1,q2\n")
    refused(scarid("trajgen", "--via", via), 65, "found no rows, expected two via points or more")


def test_sequential_and_segment_are_short_for_an_excitation_and_its_settings(scarid: Run) -> None:
    short = scarid("trajgen", "--sequential", "--segment", 1, 1.5)
    settings = ("--set", "shortest=1", "--set", "longest=1.5")
    assert short.status == 0
    assert scarid("trajgen", "--excitation", "sequential", *settings).out == short.out


def test_a_simulation_starts_where_its_trajectory_does(shell: Shell) -> None:
    """At rest at home: no error that the controller would have to make good."""
    result = shell(
        "scarid trajgen -q --duration 4 --home 0.8,-1.2 | scarid simulate --torque-noise 0"
        " --encoder-bits 0 --truth"
    )
    assert result.status == 0, result.err
    log = columns(result.out)
    for i, home in ((1, 0.8), (2, -1.2)):
        assert log[f"q{i}_true"][0] == home
        early = log[f"q{i}_true"][:3] - log[f"q{i}_ref"][:3]
        assert np.abs(early).max() < 1e-3
        assert log[f"tau{i}"][0] == pytest.approx(0.0, abs=1e-9)
