"""`scarid identify` on a measurement, and the pipe that it says does the same."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.csv as pc
import pyarrow.parquet as pq
import pytest
from conditions import Condition, robot_named
from conditions import log as simulated
from conftest import Result, refused

Run = Callable[..., Result]


@pytest.fixture
def log(samples: Path) -> Path:
    return samples / "scara2.csv"


def pipe(err: str) -> str:
    """The pipe that identify says does the same."""
    found = re.search(r"^scarid identify: the same as: (.*)$", err, re.MULTILINE)
    assert found
    return found[1]


@pytest.mark.parametrize(
    "options",
    [
        "",
        "--robot scara2 --drop-slow 0.1,0.2",
        "--estimator rls --no-align --set weights=0",
        "--estimator ml --all-rows",
        "--decimate 2 --essential",
        "--initial apriori",
    ],
)
def test_the_printed_pipe_gives_the_same_bytes(options: str, shell: Run) -> None:
    once = shell(f"scarid identify {options} $SAMPLES/scara2.csv".replace("  ", " "))
    assert once.status == 0, once.err
    line = pipe(once.err)
    assert line.count(" | ") == 1
    again = shell(line)
    assert again.out == once.out
    assert again.err.splitlines() == [
        x for x in once.err.splitlines() if "are estimated from" not in x and "the same as" not in x
    ]


def test_a_measurement_may_come_through_a_pipe(shell: Run) -> None:
    once = shell("scarid identify $SAMPLES/scara2.csv")
    piped = shell("cat $SAMPLES/scara2.csv | scarid identify")
    assert piped.out == once.out
    assert shell(f"cat $SAMPLES/scara2.csv | {pipe(piped.err)}").out == once.out


def test_a_low_pass_of_the_torque_is_found_and_validate_applies_it(
    shell: Run, tmp_path: Path
) -> None:
    """As a delay, the low-pass makes MX2 wrong by 0.2 %.

    The log has what the low-pass makes of a torque that is held for 1 ms at a time, at the instants
    when it changes: h / (1 - exp(-h / T)) late, 0.016 ms more than by T and half a period h.
    """
    robot = robot_named("planar2-gravity")
    filtered = Condition("filtered", {"torque-bandwidth": (30.0,)})
    for seed in (60_000, 60_001):
        batches = simulated(robot, filtered, seed).batches
        pc.write_csv(pa.Table.from_batches(list(batches)), tmp_path / f"{seed}.csv")
    done = shell("scarid identify --robot planar2-gravity 60000.csv -o p.parquet")
    assert "ms (+- 0.0" in done.err
    h, lag = 1e-3, 1.0 / (2.0 * np.pi * 30.0)
    late = h / (1.0 - np.exp(-h / lag)) - 0.5 * h
    text = f"as behind a low-pass of {1.0 / (2.0 * np.pi * late):.3g} Hz"
    assert text in done.err
    table = pq.read_table(tmp_path / "p.parquet")
    found = dict(
        zip(*(table.column(c).to_pylist() for c in ("parameter", "estimate")), strict=True)
    )
    assert found["MX2"] == pytest.approx(robot.apriori[robot.names.index("MX2")], rel=3e-4)
    (differentiate,) = re.findall(r"(scarid differentiate .*?)60000.csv", pipe(done.err))
    validated = shell(f"{differentiate} 60001.csv | scarid validate --parameters p.parquet")
    assert text in validated.err
    assert "scarid validate: unchanged" in validated.err


def test_torques_of_a_slower_sensor_are_interpolated_as_by_resample(shell: Run) -> None:
    simulated = shell(
        "scarid trajgen --seed 5 --duration 10 | scarid simulate --with torque-rate=50 -o held.csv"
    )
    assert simulated.status == 0, simulated.err
    once = shell("scarid identify --robot scara2 held.csv")
    assert "held.csv: torques are new every 20 ms only, rows every 5 ms" in once.err
    assert pipe(once.err).startswith("scarid resample --rate 200 --format arrow held.csv | ")
    assert shell(pipe(once.err)).out == once.out


def test_a_measurement_is_identified_by_the_recommended_procedure(log: Path, scarid: Run) -> None:
    result = scarid("identify", log)
    assert "cut-off" in result.err
    assert "scara2, gls, " in result.err
    assert "torques lead by" in result.err
    assert "left out" in result.err
    assert "\nscarid identify: good: " in result.err


def test_rows_are_whitened_where_the_torque_has_a_part_that_lasts(shell: Run) -> None:
    """Noise with a correlation time of 2 s; tests/unit/test_whitening.py has what it gains."""
    result = shell(
        "scarid trajgen -q --seed 3 --duration 20 | scarid simulate -q --seed 3"
        " --with coloured-torque-noise=0.3,0.05 --with torque-noise-time=2 -o log.csv;"
        " for options in '' --essential; do"
        " scarid identify $options log.csv | grep '^F[vs]1' | cut -d, -f3; done"
    )
    assert result.status == 0, result.err
    assert result.err.count("samples, whitened, as the residuals are correlated in time") == 2
    _, _, dropped, _ = (float(x) for x in result.out.split())
    assert dropped == 0.0  # Fv1 is not essential


def test_offsets_of_the_torques_are_fitted_and_a_new_one_is_a_change(
    shell: Run, tmp_path: Path
) -> None:
    """The robot has no term for them. Without them Fs1 would be off by 16 % (seed 3)."""
    once = shell(
        "scarid trajgen -q --seed 3 -o r.parquet && scarid simulate --with torque-offset=0.3,0.1"
        " r.parquet --format arrow | scarid identify -o p.parquet"
    )
    assert re.search(
        r": good: .*; offsets of the torques, for which the robot has no term, were fitted as well:"
        r" 0\.\d+ N m at joint 1 and 0\.\d+ N m at joint 2 \(add the term offset",
        once.err,
    ), once.err
    found = {row["parameter"]: row for row in pq.read_table(tmp_path / "p.parquet").to_pylist()}
    assert found["Fs1"]["low"] < 0.58 < found["Fs1"]["high"]
    assert found["Fs1"]["robust_error"] < 0.01
    same, other = (
        shell(
            f"scarid simulate -q --seed 7 --with torque-offset={offset} r.parquet --format arrow"
            " | scarid validate --parameters p.parquet"
        ).err
        for offset in ("0.3,0.1", "0.3,0.2")
    )
    assert "scarid validate: unchanged: " in same
    assert re.search(r"changed: offset of joint 2 \(offset 2 \+0\.(09|10)", other), other


def test_friction_of_the_load_is_fitted_and_predicted(shell: Run, tmp_path: Path) -> None:
    """The robot has no term for it. Without it Fc1 would be 26 % too large."""
    once = shell(
        "export SCARID_ROBOT=planar2-gravity; for seed in 3 4; do"
        " scarid trajgen -q --seed $seed --q-max 2,2 --ddq-max 20,30 --duration 20 |"
        " scarid simulate -q --seed $seed --with load-friction=0.02 -o log$seed.parquet; done;"
        " scarid identify log3.parquet -o p.parquet"
    )
    assert re.search(
        r": good: .*; friction of joints 1 and 2 grows with the transmitted torque, for which there"
        r" is no term; fitted as well: 0\.0(2|19\d+|20\d+) and 0\.0(18|19|2)\d* of this torque",
        once.err,
    ), once.err
    found = {row["parameter"]: row for row in pq.read_table(tmp_path / "p.parquet").to_pylist()}
    assert found["MX1R"]["estimate"] == pytest.approx(0.1987, rel=5e-3)
    assert found["Fc1"]["estimate"] == pytest.approx(0.166, rel=0.06)
    checked = "scarid validate --robot planar2-gravity log4.parquet --parameters"
    kept, lost = (
        shell(f"scarid convert -q p.parquet | cut -d, -f-8 > p.csv; {checked} {file}")
        for file in ("p.parquet", "p.csv")
    )
    assert "added the torques that identify fitted beside those of the model" in kept.err
    assert "scarid validate: unchanged: " in kept.err
    errors = [
        [float(row["relative_error"]) for row in csv.DictReader(one.out.splitlines())]
        for one in (kept, lost)
    ]
    assert all(own < 0.9 * other for own, other in zip(*errors, strict=True))


def test_torque_ripple_is_fitted_and_predicted(shell: Run, tmp_path: Path) -> None:
    """As of cogging motors: 0.2 N m with 10 and 0.03 N m with 8 periods per rad."""
    once = shell(
        "for seed in 3 4; do scarid trajgen -q --seed $seed --duration 20 | scarid simulate -q"
        " --seed $seed --with ripple=0.2,0.03 --with ripple-cycles=10,8 -o log$seed.parquet; done;"
        " scarid identify log3.parquet -o p.parquet"
    )
    number = r"([\d.]+)"
    found = re.search(
        r": good: .*; the torque of joints 1 and 2 ripples with the position"
        rf" \({number} periods per rad at joint 1, {number} periods per rad at joint 2\), as of"
        r" cogging motors or of gears, for which there is no term; fitted as well,"
        rf" with {number} N m at joint 1, {number} N m at joint 2\n",
        once.err,
    )
    assert found, once.err
    assert [float(x) for x in found.groups()] == pytest.approx([10.0, 8.0, 0.2, 0.03], rel=0.1)
    checked = "scarid validate log4.parquet --parameters"
    kept, lost = (
        shell(f"scarid convert -q p.parquet | cut -d, -f-8 > p.csv; {checked} {file}")
        for file in ("p.parquet", "p.csv")
    )
    assert "scarid validate: unchanged: " in kept.err
    own, other = (
        [float(row["relative_error"]) for row in csv.DictReader(one.out.splitlines())]
        for one in (kept, lost)
    )
    assert all(x < 0.9 * y for x, y in zip(own, other, strict=True))


def test_the_offset_beside_a_spring_is_not_better_known_than_where_it_is_slack(
    shell: Run, tmp_path: Path
) -> None:
    """A cable of 0.1 N m/rad that is slack at 1 rad, beside the offset of a joint."""
    result = shell(
        "scarid trajgen -q --robot planar2-gravity --seed 3 --q-max 2,2 --ddq-max 20,30"
        " --duration 20 | scarid simulate -q --robot planar2-gravity --seed 3 --format csv |"
        " awk -F, -v OFS=, 'NR > 1 { $4 += 0.1 * ($2 - 1) } 1' > log.csv;"
        " scarid identify --robot planar2-gravity log.csv -o p.parquet"
    )
    assert "something pulls on joint 1 as a spring or a cable does" in result.err, result.err
    assert re.search(r"fitted as well: 0\.(09|1)\d* N m/rad", result.err), result.err
    found = {row["parameter"]: row for row in pq.read_table(tmp_path / "p.parquet").to_pylist()}
    assert found["offset1"]["low"] < 0.0 < found["offset1"]["high"]
    assert found["offset1"]["robust_error"] > 0.05
    assert found["offset2"]["robust_error"] < 0.01


@pytest.mark.parametrize(("torque", "told"), [("0", "not identifiable"), ("0.3", "doubtful")])
def test_a_constant_torque_has_no_r2_and_does_not_disturb_the_other_joint(
    torque: str, told: str, shell: Run
) -> None:
    """All torques of the second joint explain hardly any of the parameters of the first."""
    whole = shell("scarid identify $SAMPLES/scara2.csv")
    one = shell(
        f"cut -d, -f-5 $SAMPLES/scara2.csv | sed -E '2,$s/[^,]+$/{torque}/' | scarid identify"
    )
    assert re.search(rf"identify: {told}: .*R2 joint 1 0\.99\d\d, joint 2 undefined", one.err)
    _, _, expected, *_ = whole.out.splitlines()[1].split(",")
    low, high = one.out.splitlines()[1].split(",")[6:8]
    assert float(low) < float(expected) < float(high)


def test_a_measurement_without_torques_is_refused(log: Path, tmp_path: Path, scarid: Run) -> None:
    bare = tmp_path / "bare.csv"
    lines = log.read_text("utf-8").splitlines()
    bare.write_text("\n".join(",".join(line.split(",")[:3]) for line in lines) + "\n")
    refused(scarid("identify", bare), 65, "column tau1")


def test_a_jittered_measurement_is_refused_with_what_to_type(
    log: Path, tmp_path: Path, scarid: Run
) -> None:
    jittered = tmp_path / "jittered.csv"
    lines = log.read_text("utf-8").splitlines(keepends=True)
    jittered.write_text("".join([*lines[:100], *lines[101:]]))
    refused(scarid("identify", jittered), 65, "scarid resample --rate")


def test_too_short_a_measurement_is_refused(log: Path, tmp_path: Path, scarid: Run) -> None:
    short = tmp_path / "short.csv"
    short.write_text("".join(log.read_text("utf-8").splitlines(keepends=True)[:30]))
    refused(scarid("identify", short), 65, "short.csv: ", "too few rows")


def test_measurements_can_be_identified_one_after_the_other(tmp_path: Path, shell: Run) -> None:
    """Row by row, so without the delay."""
    first, second = (
        shell(f"scarid identify {words} $SAMPLES/scara2.csv")
        for words in ("--save s.npz", "--from s.npz")
    )
    assert first.status == second.status == 0, first.err + second.err
    assert "scara2, rls, " in second.err
    assert (tmp_path / "s.npz").exists()


def test_rows_that_count_are_the_same_in_identify_and_validate(shell: Run) -> None:
    result = shell(
        "scarid differentiate $SAMPLES/scara2.csv -o m.parquet &&"
        " scarid identify --estimator wls m.parquet -o p.parquet &&"
        " scarid validate --parameters p.parquet m.parquet > metrics.csv"
    )
    assert result.status == 0, result.err
    said = [line.partition(": ")[2] for line in result.err.splitlines() if "left out" in line]
    assert len(said) == 2
    assert said[0] == said[1]
    all_rows = shell("scarid validate --all-rows --parameters p.parquet m.parquet")
    assert "left out" not in all_rows.err


def test_validate_takes_a_log_with_the_bandwidth_of_the_identification(shell: Run) -> None:
    identified = shell("scarid identify $SAMPLES/scara2.csv -o p.parquet")
    (hertz,) = re.findall(r"cut-off ([\d.]+) Hz", identified.err)
    once = shell("scarid validate --parameters p.parquet $SAMPLES/scara2.csv")
    assert once.status == 0, once.err
    assert f"cut-off {hertz} Hz for all joints, as at the identification" in once.err
    assert "unchanged: residual joint 1 " in once.err
    (line,) = re.findall(r"^scarid validate: the same as: (.*)$", once.err, re.MULTILINE)
    assert shell(line).out == once.out
    of_identify = pipe(identified.err).split(" | ")[0]
    assert line.split(" | ")[0] == of_identify


def test_a_change_is_found_beside_a_short_log(shell: Run) -> None:
    """The sample has five seconds, whose every block the fit follows."""
    shell("scarid identify $SAMPLES/scara2.csv -o p.parquet")
    found = shell(
        "scarid trajgen -q --seed 5 | scarid simulate -q --seed 5"
        " --with torque-constant-error=0.1,0 -o log.parquet &&"
        " scarid validate --parameters p.parquet log.parquet"
    )
    assert found.status == 0, found.err
    (gain,) = re.findall(r"changed: motor constant of joint 1 \(torques \+(\S+) \+-", found.err)
    assert float(gain) == pytest.approx(10.0, abs=1.0)


@pytest.mark.parametrize("parameters", ["p.parquet", "p.csv"])
def test_validate_names_the_time_at_which_the_robot_was_pushed(
    parameters: str, shell: Run, tmp_path: Path
) -> None:
    shell("scarid trajgen --seed 3 --duration 20 | scarid simulate --seed 3 -o log.parquet")
    shell(f"scarid identify log.parquet -o {parameters}")
    table = pq.read_table(tmp_path / "log.parquet")
    t = table["t"].to_numpy()
    pushed = table["tau1"].to_numpy() + np.where(np.abs(t - 7.55) < 0.3, 5.0, 0.0)
    at = table.column_names.index("tau1")
    pq.write_table(table.set_column(at, table.field(at), pa.array(pushed)), tmp_path / "p.log")
    found = shell(f"scarid validate --parameters {parameters} p.log")
    assert found.status == 0, found.err
    assert "\nscarid validate: unexplained: " in found.err
    assert re.search(r"residual are those at 7\.1 to (7\.9|8) s \(a contact, or", found.err)


def test_validate_chooses_a_bandwidth_where_the_parameters_have_none(shell: Run) -> None:
    shell("scarid identify $SAMPLES/scara2.csv | cut -d, -f-8 > p.csv")
    found = shell("scarid validate --parameters p.csv $SAMPLES/scara2.csv")
    assert found.status == 0, found.err
    assert "the estimates agree best" in found.err


@pytest.mark.parametrize(("late", "told"), [("0.02", "lag by"), ("0", "lead by")])
def test_torques_that_lag_are_told_with_their_likely_causes(
    late: str, told: str, shell: Run
) -> None:
    log = f"scarid trajgen --seed 1 | scarid simulate --with torque-delay={late}"
    found = shell(f"{log} | scarid identify")
    assert f"torques {told}" in found.err
    assert ("as if the positions were commands" in found.err) == (told == "lag by")
