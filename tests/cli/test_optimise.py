"""`trajgen --optimise` as a user sees it: what is written, reported and refused."""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from conftest import Result, long, refused

from scarid_cli.algorithms.design.aims import AIMS
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.algorithms.trajectories.limits import Limits
from scarid_cli.arrays import Array

Run = Callable[..., Result]
Shell = Callable[..., Result]
SHORT = ("trajgen", "--optimise", "--starts", "2", "--duration", "5")


def motion_in(path: Path, joints: int) -> tuple[Array, tuple[Array, Array, Array]]:
    """The times and the motion in a Parquet file."""
    table = pq.read_table(path)
    t = table.column("t").to_numpy()
    signals = (
        np.array([table.column(f"{name}{i + 1}_ref").to_numpy() for i in range(joints)])
        for name in ("q", "dq", "ddq")
    )
    return t, tuple(signals)  # type: ignore[return-value]


def errors_in(path: Path) -> dict[str, float]:
    with path.open() as file:
        return {row["parameter"]: float(row["expected_error"]) for row in csv.DictReader(file)}


def conditions(result: Result) -> tuple[float, float]:
    found = re.search(r"number of W ([\d.]+), of its scaled columns ([\d.]+)", result.err)
    assert found, result.err
    return float(found[1]), float(found[2])


@long
def test_the_condition_number_of_the_scara_can_be_below_3(scarid: Run) -> None:
    """Random motions have 9.4 to 19.7."""
    result = scarid("trajgen", "--optimise", "--criterion", "c", "--starts", 2, "--seed", 1)
    assert result.status == 0, result.err
    assert conditions(result)[0] < 3.0


def test_a_robot_keeps_all_its_limits(scarid: Run, samples: Path, tmp_path: Path) -> None:
    """On a grid of a millisecond: position, velocity, acceleration, and torque."""
    pytest.importorskip("pinocchio")
    name, out = samples / "robots/ur10e.toml", tmp_path / "reference.parquet"
    home = "0,-1.5707963,0,-1.5707963,0,0"
    words = ("--robot", name, "--home", home, "--rate", 1000, "-o", out)
    result = scarid(*SHORT, *words)
    assert result.status == 0, result.err
    robot = load(str(name))
    t, motion = motion_in(out, 6)
    Limits.of(robot.joints).require(t, *motion)
    torques = robot.torques(robot.regressor(*motion), robot.apriori)
    assert np.all(np.abs(torques) <= np.array([[j.torque_limit] for j in robot.joints]))
    assert "limited by: " in result.err
    assert "acceleration of joint" in result.err
    assert re.search(r"predicted relative errors .*; unknown: ", result.err)


@long
def test_torques_limit_the_motion_where_they_are_small(
    scarid: Run, samples: Path, tmp_path: Path
) -> None:
    weak = (samples.parent / "scarid_cli/algorithms/robots/scara2.toml").read_text()
    weak = weak.replace("torque_noise = 0.2 ", "torque_limit = 15.0\ntorque_noise = 0.2 ")
    path, out = tmp_path / "weak.toml", tmp_path / "reference.parquet"
    path.write_text(weak)
    result = scarid(*SHORT, "--robot", path, "--criterion", "d", "--rate", 1000, "-o", out)
    assert result.status == 0, result.err
    robot = load(str(path))
    _, motion = motion_in(out, 2)
    largest = np.abs(robot.torques(robot.regressor(*motion), robot.apriori)[0]).max()
    assert 14.5 < largest <= 15.0
    assert "torque of joint 1" in result.err


@pytest.mark.parametrize("excitation", ["spline", pytest.param("fourier", marks=long)])
def test_the_same_seed_and_number_of_starts_give_the_same_bytes(
    excitation: str, scarid: Run, tmp_path: Path
) -> None:
    def made(name: str, seed: int) -> bytes:
        out = tmp_path / f"{name}.parquet"
        words = ("--excitation", excitation, "--no-history", "--seed", seed, "-o", out)
        assert scarid(*SHORT, "--duration", 2, *words).status == 0
        return out.read_bytes()

    one = made("one", 1)
    assert made("same", 1) == one
    assert made("other", 2) != one


def test_a_budget_is_spent_on_starts(scarid: Run) -> None:
    words = ("trajgen", "--optimise", "--duration", 3, "--budget", 0.01)
    assert re.search(r"the best of \d+ starts", scarid(*words).err)


def test_an_experiment_can_aim_at_some_parameters(scarid: Run, tmp_path: Path) -> None:
    aimed, every = tmp_path / "aimed.csv", tmp_path / "all.csv"
    assert scarid(*SHORT, "--for", "Fv1,Fs1", "--expected", aimed).status == 0
    assert scarid(*SHORT, "--criterion", "d", "--expected", every).status == 0
    ratios = {name: error / errors_in(every)[name] for name, error in errors_in(aimed).items()}
    assert ratios["Fv1"] * ratios["Fs1"] < 0.85
    assert max(ratios.values()) > 1.2  # what the others pay


@pytest.fixture
def before(shell: Shell, tmp_path: Path) -> Path:
    """The parameters of a random experiment of 5 s."""
    pipe = (
        "scarid trajgen -q --seed 3 --duration 5 | scarid simulate --seed 3 |"
        " scarid differentiate | scarid identify -q --estimator wls --drop-slow 0.1"
        " -o before.parquet"
    )
    result = shell(pipe)
    assert result.status == 0, result.err
    return tmp_path / "before.parquet"


def test_an_experiment_complements_earlier_ones(before: Path, scarid: Run, tmp_path: Path) -> None:
    """Together they know more of every parameter than the earlier ones alone."""
    after = tmp_path / "after.csv"
    assert scarid(*SHORT, "--after", before, "--expected", after).status == 0
    document = json.loads(pq.read_schema(before).metadata[b"scarid"])
    known = np.sqrt(np.diag(document["extra"]["covariance"]))
    both = np.array(list(errors_in(after).values()))
    assert np.all(both < known)
    assert np.median(both / known) < 0.6


def test_periods_are_repeated_after_a_slow_approach(scarid: Run, tmp_path: Path) -> None:
    out = tmp_path / "reference.parquet"
    words = ("--excitation", "fourier", "--duration", 4, "--repeat", 3, "--approach", "0.6,-0.8")
    assert scarid("trajgen", *words, "-o", out).status == 0
    t, (q, dq, ddq) = motion_in(out, 2)
    start = len(t) - 1 - 3 * 800  # rows of 5 ms
    assert q[:, 0] == pytest.approx([0.6, -0.8])
    assert (q[:, start], dq[:, start], ddq[:, start]) == (
        pytest.approx([0.0, 0.0], abs=1e-12), pytest.approx([0.0, 0.0], abs=1e-12),
        pytest.approx([0.0, 0.0], abs=1e-9),
    )  # fmt: skip
    limits = Limits.of(load("scara2").joints)
    assert np.all(0.2001 * limits.dq >= np.abs(dq[:, :start]).T)
    assert np.all(0.2001 * limits.ddq >= np.abs(ddq[:, :start]).T)
    periods = q[:, start:-1].reshape(2, 3, 800)
    np.testing.assert_allclose(periods[:, 1:], periods[:, :1].repeat(2, axis=1), atol=1e-9)


def test_expected_errors_of_a_random_motion(scarid: Run, tmp_path: Path) -> None:
    out = tmp_path / "errors.csv"
    words = ("trajgen", "--robot", "scara2")
    plain, result = scarid(*words), scarid(*words, "--expected", out)
    assert result.out == plain.out
    assert result.err.splitlines()[0].startswith(plain.err.split("condition")[0].rstrip(", "))
    assert list(errors_in(out)) == load("scara2").names


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--criterion", "d"), "--criterion needs --optimise"),
        (("--for", "ZZ2"), "--for needs --optimise"),
        (("--starts", "3"), "--starts needs --optimise"),
        (("--align",), "--align needs --expected or --optimise"),
        (("--drop-slow", "0.1"), "--drop-slow needs --expected or --optimise"),
        (("--expected", "-", "--drop-slow", "-1"), "--drop-slow: velocities cannot be negative"),
        (("--optimise", "--excitation", "quintic"), "the excitation must be spline or fourier"),
        (("--optimise", "--for", "ZZ9"), "--for: no parameter 'ZZ9'; there are ZZ1R, Fv1"),
        (("--optimise", "--for", "ZZ2", "--criterion", "c"), "has no form for some parameters"),
        (("--optimise", "--for", "gains", "--criterion", "c"), "has no form for some parameters"),
        (("--optimise", "--for", "payload"), "has no URDF, so its flange is not known"),
        (("--optimise", "--for", "ZZ2,gains"), "and alone gains or payload"),
        (("--optimise", "--for", "gains", "--robot", "emps"), "the gain of its only joint"),
        (("--optimise", "--home", "0,1.5"), "--home: joint 2 stands at a limit of -1.5 to 1.5"),
        (("--optimise", "--workspace", "0,1,0,1"), "--workspace: give XMIN,XMAX,YMIN,YMAX"),
        (("--optimise", "--workspace", "0,1,0,1,0,1"), "has no URDF, so its tool is not known"),
        (("--torque-noise", "0"), "--torque-noise must be positive"),
        (("--approach", "0,9"), "the position of joint 2 is 9, allowed is -1.5 to 1.5"),
    ],
)
def test_what_cannot_be_optimised_is_refused(
    words: tuple[str, ...], message: str, scarid: Run
) -> None:
    refused(scarid("trajgen", *words), 2, message)


def test_an_aim_has_no_earlier_experiments(before: Path, scarid: Run) -> None:
    result = scarid(*SHORT, "--for", "gains", "--after", before)
    refused(result, 2, "--for gains: --after complements parameters; leave it out")


def test_a_table_without_covariance_is_refused(before: Path, scarid: Run, tmp_path: Path) -> None:
    assert scarid("convert", before, "-o", tmp_path / "before.csv").status == 0
    result = scarid(*SHORT, "--after", tmp_path / "before.csv")
    refused(result, 65, "no covariance of the estimates", "identify -o parameters.parquet")


GAIN = re.compile(r"joint (\d) \+-([\d.]+) %")


def test_a_motion_for_the_gains_tells_them_better_than_another(
    scarid: Run, samples: Path, tmp_path: Path
) -> None:
    """The half intervals that `identify --free-gains` states, beside those that are predicted."""

    def stated(name: str, *words: str) -> tuple[float, float]:
        """Of one joint beside the other [%]: predicted (or nan), and of a simulated log."""
        out, log, found = (tmp_path / f"{name}-{x}.parquet" for x in ("motion", "log", "found"))
        planned = scarid("trajgen", *words, "--duration", 5, "-o", out)
        assert planned.status == 0, planned.err
        assert scarid("simulate", "-q", "--seed", 1, out, "-o", log).status == 0
        result = scarid("identify", "-q", "--free-gains", 2, log, "-o", found)
        assert result.status == 0, result.err
        extra = json.loads(pq.read_schema(found).metadata[b"scarid"])["extra"]
        ((_, error),) = extra["relative_gains"].values()
        told = GAIN.search(planned.err)
        return float(told[2]) if told else float("nan"), 196.0 * error

    aimed = ("--optimise", "--starts", "2", "--for", "gains")
    predicted, half = stated("aimed", *aimed)
    assert 0.8 < half / predicted < 3.0  # accelerations from encoders are noisy too
    assert half < 0.75 * stated("random", "--seed", "3")[1]


def test_a_motion_for_a_payload_says_how_well_it_will_weigh(
    scarid: Run, samples: Path, tmp_path: Path
) -> None:
    pytest.importorskip("pinocchio")
    words = ("--robot", samples / "robots/ur10e.toml", "-o", tmp_path / "motion.parquet")
    result = scarid(*SHORT, *words, "--for", "payload")
    assert result.status == 0, result.err
    found = re.search(
        r"predicted for 1 kg in the origin of tool, and the bare robot moved alike: "
        r"mass \+-([\d.]+) kg, centre \+-([\d.]+) m, inertia \+-([\d.]+) kg m2",
        result.err,
    )
    assert found, result.err
    mass, centre, inertia = (float(x) for x in found.groups())
    assert 1e-3 < mass < 0.1
    assert centre < 0.05
    assert inertia < 0.1
    other = tmp_path / "other.parquet"
    assert scarid(*SHORT, *words[:2], "-o", other).status == 0
    # Over three seeds the errors are 1.8 to 2.2 times smaller.
    assert volume(tmp_path / "motion.parquet", words[1]) < volume(other, words[1]) - np.log(1.3)


def volume(motion: Path, robot: Path) -> float:
    """The mean logarithm of the standard errors of what a motion tells of a payload.

    Of equally weighted torques, in least squares by QR, apart from how the optimiser computes it.
    """
    arm = load(str(robot))
    aim = AIMS["payload"](arm)
    _, signals = motion_in(motion, len(arm.joints))
    W = aim.model.regressor(tuple(x[:, ::10] for x in signals)).transpose(1, 0, 2)  # type: ignore[arg-type]
    W /= np.array([joint.torque_noise for joint in arm.joints])[:, None, None]
    nuisance, wanted = W[..., aim.wanted :], W[..., : aim.wanted]
    R = np.linalg.qr(np.concatenate([nuisance, wanted], axis=2).reshape(-1, aim.columns))[1]
    own = np.abs(np.diag(R))[nuisance.shape[2] :]
    return float(-np.mean(np.log(own)))
