"""The benchmarks follow the interfaces that they measure: each imports, and a small part runs."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

import arms
import defaults
import differentiators
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
import shells
import speed
from conftest import ROOT
from scores import Score, cost
from signals import motions, seen

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.algorithms.robots.reading import load

MODULES = sorted(path.stem for path in (ROOT / "benchmarks").glob("*.py"))


@pytest.mark.parametrize("name", MODULES)
def test_every_benchmark_imports(name: str) -> None:
    assert import_module(name).__doc__


def test_the_errors_behind_the_defaults_are_those_of_filtered_positions() -> None:
    """A Butterworth filter of order 4 delays slow motion by 2.613 / (2 pi 20 Hz): by 4 rows."""
    log = defaults.experiment(1, (2.0, 4.0))
    found = defaults.errors(log, "backward", {})
    for (velocity, _), dq in zip(found, log.dq_true[:, :: defaults.RATIO], strict=True):
        late = np.sqrt(np.mean((dq[196:-4] - dq[200:]) ** 2)) / np.std(dq)
        assert 0.9 * late < velocity < 1.5 * late


def test_the_figures_of_a_differentiator_are_those_of_its_errors() -> None:
    """An exact sensor has neither error nor delay; one that lags by five rows has this delay."""
    quintic = motions()[0]
    score = Score("late", "causal", 16, ours=True)
    score.measure(lambda _: (np.roll(quintic.v, 5), np.roll(quintic.a, 5)), quintic, seed=0)
    assert score.delay == [pytest.approx(25.0, abs=1.0)]
    expected = np.sqrt(np.mean((np.roll(quintic.v, 5) - quintic.v)[200:-200] ** 2))
    assert score.v == [pytest.approx(expected / np.std(quintic.v[200:-200]))]


def test_a_method_is_tuned_by_the_truth_at_least_as_well_as_without_it() -> None:
    quintic = motions()[0]
    q = seen(quintic.q, 16, 0)
    kalman = differentiators.blind("kalman", q)
    score = Score("kalman", "causal", 16, ours=True)
    score.measure(lambda x: differentiators.derivatives(kalman, x), quintic, seed=0)
    score.informed.append(differentiators.informed(kalman, q, quintic))
    assert 1.0 <= score.of_truth < 1.2
    assert cost(DIFFERENTIATORS.load("kalman")(), q[:200]) > 0.0


def test_several_logs_are_one_record_with_gaps(tmp_path: Path) -> None:
    facts = {b"kind": b"measurement"}
    schema = pa.schema([("t", pa.float64()), ("q1", pa.float64())], facts)
    logs = [tmp_path / f"{i}.parquet" for i in range(2)]
    for i, log in enumerate(logs):
        pq.write_table(pa.table([[0.0, 0.5, 1.0], [float(i)] * 3], schema), log)
    shells.recorded(logs, tmp_path / "record.parquet")
    record = pq.read_table(tmp_path / "record.parquet")
    assert record["t"].to_pylist() == [0.0, 0.5, 1.0, 2.0, 2.5, 3.0]
    assert record["q1"].to_pylist() == [0.0, 0.0, 0.0, 1.0, 1.0, 1.0]
    assert record.schema.metadata == facts


def test_an_arm_of_a_urdf_gets_motors_and_friction(tmp_path: Path) -> None:
    pytest.importorskip("pinocchio")
    arm = load(str(arms.described(ROOT / "samples/arm.urdf", tmp_path)))
    assert [joint.acceleration_limit for joint in arm.joints] == [arms.ACCELERATION] * 2
    assert [arm.value("coulomb", i) for i in (1, 2)] == pytest.approx([0.05 * 60.0, 0.05 * 20.0])
    assert arm.value("viscous", 1) == pytest.approx(0.05 * 60.0 / 4.0)


def test_the_kernels_are_measured_with_arguments_that_they_take(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(speed, "SAMPLES", 200)
    monkeypatch.setattr(speed, "INTERPRETED_SAMPLES", 20)
    speed.kernels()
    assert len(capsys.readouterr().out.splitlines()) == 3 + 10
