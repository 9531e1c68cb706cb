"""The covariance that a parameter table carries, and what is done when it carries none."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from unit.arms import URDF, described_arm

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array
from scarid_cli.errors import BadData
from scarid_cli.io.table import Metadata, Table
from scarid_cli.stages.results.estimates import estimates_with_covariance
from scarid_cli.stages.urdf import base_table, physical, r2_report

pytest.importorskip("pinocchio")
pytest.importorskip("cvxpy")


@pytest.fixture
def robot(tmp_path: Path) -> Robot:
    (tmp_path / "two.urdf").write_text(URDF.replace("TYPE", "revolute"))
    return described_arm(str(tmp_path / "two.urdf"), tmp_path, "")


def table(robot: Robot, errors: Array | None = None, **extra: Any) -> Table:
    """A table of a priori values with robust errors, as `identify` writes it."""
    columns: dict[str, pa.Array] = {
        "parameter": pa.array(robot.names),
        "unit": pa.array([p.unit for p in robot.parameters]),
        "estimate": pa.array(robot.apriori),
    }
    if errors is not None:
        columns["robust_error"] = pa.array(errors, from_pandas=True)
    batch = pa.RecordBatch.from_pydict(columns)
    return Table("p.parquet", batch.schema, Metadata(extra=extra), iter([batch]))


def covariance_of(robot: Robot, seed: int = 0) -> Array:
    count = len(robot.names)
    root = np.random.default_rng(seed).standard_normal((count, 2 * count))
    return np.asarray(root @ root.T / count)


def test_the_covariance_comes_from_the_metadata(robot: Robot) -> None:
    covariance = covariance_of(robot)
    errors = 3.0 * np.sqrt(np.diag(covariance))
    found = estimates_with_covariance(table(robot, errors, covariance=covariance.tolist()), robot)
    np.testing.assert_allclose(found.covariance, covariance)
    np.testing.assert_allclose(found.errors, errors)
    np.testing.assert_array_equal(found.full, robot.apriori)
    assert found.remark == ""
    assert found.dropped == ()


def test_dropped_parameters_have_their_estimates_before(robot: Robot) -> None:
    covariance, full = covariance_of(robot), robot.apriori + 1.0
    found = estimates_with_covariance(
        table(robot, np.ones(len(full)), covariance=covariance.tolist(),
              full_estimates=full.tolist(), dropped=[robot.names[5], robot.names[2]]),
        robot,
    )  # fmt: skip
    np.testing.assert_array_equal(found.full, full)
    np.testing.assert_array_equal(found.values, robot.apriori)
    assert found.dropped == (2, 5)


def test_null_is_not_known(robot: Robot) -> None:
    covariance = covariance_of(robot)
    covariance[2, :] = covariance[:, 2] = np.nan
    nested = [[x if np.isfinite(x) else None for x in row] for row in covariance.tolist()]
    found = estimates_with_covariance(
        table(robot, np.sqrt(np.diag(covariance)), covariance=nested), robot
    )
    np.testing.assert_allclose(found.covariance, covariance)
    physical(found)


def test_without_a_covariance_the_errors_alone_count_and_the_remedy_is_named(robot: Robot) -> None:
    errors = np.linspace(0.1, 0.2, len(robot.names))
    found = estimates_with_covariance(table(robot, errors), robot)
    np.testing.assert_array_equal(found.covariance, np.diag(errors**2))
    assert "no covariance" in found.remark
    assert "identify -o parameters.parquet" in found.remark


def test_zeros_without_errors_were_dropped(robot: Robot) -> None:
    """In CSV nothing else says so."""
    errors = np.full(len(robot.names), 0.1)
    zero = np.flatnonzero(robot.apriori == 0.0)[:2]
    errors[zero] = np.nan
    found = estimates_with_covariance(table(robot, errors), robot)
    assert found.dropped == tuple(zero.tolist())


def test_without_any_errors_all_parameters_weigh_the_same(robot: Robot) -> None:
    found = estimates_with_covariance(table(robot), robot)
    np.testing.assert_array_equal(found.covariance, np.eye(len(robot.names)))
    assert found.dropped == ()
    assert "no errors" in found.remark


@pytest.mark.parametrize("kind", ["indefinite", "negative"])
def test_what_is_no_covariance_is_not_used(kind: str, robot: Robot) -> None:
    covariance = covariance_of(robot)
    if kind == "indefinite":
        covariance[0, 1] = covariance[1, 0] = 2.0 * np.sqrt(covariance[0, 0] * covariance[1, 1])
    else:
        covariance[0, 0] = -1.0
    errors = np.full(len(covariance), 0.1)
    found = estimates_with_covariance(table(robot, errors, covariance=covariance.tolist()), robot)
    np.testing.assert_array_equal(found.covariance, np.diag(errors**2))
    assert "negative variances" in found.remark


def test_parameters_known_in_combinations_alone_move_in_those(robot: Robot) -> None:
    """A singular covariance: what has no variance keeps its value, to a part of the errors."""
    root = np.random.default_rng(1).standard_normal((len(robot.names), 4))
    covariance = root @ root.T
    errors = np.sqrt(np.diag(covariance))
    own = table(robot, errors, covariance=covariance.tolist())
    found = estimates_with_covariance(own, robot)
    assert found.remark == ""
    moved = physical(found).base - found.full
    across = moved - root @ np.linalg.lstsq(root, moved, rcond=None)[0]
    assert np.abs(across / errors).max() < 1e-4


@pytest.mark.parametrize("stored", [[[1.0]], [[1.0, 2.0], [3.0]], "none", 3.0])
def test_a_covariance_of_another_size_is_bad_data(stored: Any, robot: Robot) -> None:
    errors = np.full(len(robot.names), 0.1)
    with pytest.raises(BadData, match=r"p\.parquet: found metadata `covariance`"):
        estimates_with_covariance(table(robot, errors, covariance=stored), robot)


def test_what_the_torques_are_not_linear_in_keeps_its_value(robot: Robot) -> None:
    """Stribeck velocities of `separable`: the others have the covariance given their value."""
    wide = robot.with_stribeck({1: 0.05})
    own = table(wide, np.full(len(wide.names), 0.1))
    batch = next(own.batches)
    last = pa.RecordBatch.from_pydict(
        {"parameter": ["vs1"], "unit": ["rad/s"], "estimate": [0.05], "robust_error": [0.1]},
        schema=batch.schema,
    )
    covariance = covariance_of(wide.with_stribeck({2: 0.05}))  # of as many rows as the table
    meta = replace(own.meta, extra={"covariance": covariance.tolist()})
    found = estimates_with_covariance(replace(own, meta=meta, batches=iter([batch, last])), robot)
    assert found.robot.names == wide.names
    assert found.fixed == (("vs1", "rad/s", 0.05),)
    # The inverse of a block of the information is the covariance given the others.
    given = np.linalg.inv(np.linalg.inv(covariance)[:-1, :-1])
    np.testing.assert_allclose(found.covariance, given)
    written = next(base_table(own, found, physical(found)).batches)
    assert written.column("parameter").to_pylist() == [*wide.names, "vs1"]
    assert written.column("estimate").to_pylist()[-1] == 0.05


@pytest.mark.parametrize(
    ("before", "after", "falls"),
    [
        ([0.998, 0.93], [0.997, 0.92], ""),
        ([0.998, 0.928], [0.998, -1.35], "joint 2 from 0.928 to -1.350"),
        ([0.998, 0.93], [0.97, 0.5], "joint 1 from 0.998 to 0.970, joint 2 from 0.930 to 0.500"),
        ([1.0, 0.9999999], [1.0, 0.999], ""),
        ([0.5, 0.5], [0.6, 0.9], ""),
    ],
)
def test_a_collapse_of_r2_is_a_warning(before: list[float], after: list[float], falls: str) -> None:
    lines = list(r2_report(np.array(before), np.array(after)))
    assert ", ".join(f"{x:.3f}" for x in before) in lines[0]
    assert ", ".join(f"{x:.3f}" for x in after) in lines[1]
    assert len(lines) == (3 if falls else 2)
    assert not falls or ("warning" in lines[2] and falls in lines[2])
