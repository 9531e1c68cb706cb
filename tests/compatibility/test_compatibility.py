"""What older versions wrote and took, this version reads and takes (docs/compatibility.md)."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from compatibility.contract import contract
from conftest import ROOT, Result
from pyarrow import parquet

HERE = Path(__file__).parent
VERSIONS = sorted(path.name for path in HERE.iterdir() if (path / "contract.json").is_file())
TABLES = [
    (version, path.name)
    for version in VERSIONS
    for path in sorted((HERE / version).iterdir())
    if path.name not in ("contract.json", "settings.toml")
]
# Each table by a command that reads it.
READING = """
simulate trajectory.parquet
check measurement.csv
check measurement.arrow
resample --rate 40 measurement.parquet
filter --cutoff 8 measurement.arrow
differentiate --settings settings.toml measurement.parquet
identify measurement.csv
identify --gains gains.parquet measurement.parquet
identify motion.csv
identify --initial parameters.csv motion.parquet
compare parameters.csv parameters.parquet
report parameters.parquet trace.csv metrics.csv prediction.parquet
export --robot arm.toml --parameters arm.parquet
urdf arm.toml --parameters arm.parquet
""".strip().splitlines()
Run = Callable[..., Result]


@pytest.fixture(params=VERSIONS)
def kept(request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of what a version wrote, with the descriptions of the robots."""
    folder = tmp_path / "kept"
    shutil.copytree(HERE / request.param, folder)
    for name in ("arm.toml", "arm.urdf"):
        shutil.copy(ROOT / "samples" / name, folder)
    monkeypatch.chdir(folder)
    return folder


@pytest.mark.parametrize(("version", "table"), TABLES)
def test_every_table_is_recognised(version: str, table: str, scarid: Run) -> None:
    done = scarid("info", HERE / version / table)
    assert (done.status, done.err) == (0, "")
    kind = table.split(".")[0].replace("arm", "parameters")
    assert kind in done.out


@pytest.mark.parametrize("line", READING)
def test_every_table_is_read(line: str, kept: Path, scarid: Run) -> None:
    done = scarid(*line.split())
    assert done.status == 0, done.err
    assert done.out


@pytest.mark.parametrize("name", ["measurement.parquet", "measurement.arrow", "motion.parquet",
                                  "parameters.parquet"])  # fmt: skip
def test_no_bit_of_a_number_is_lost(name: str, kept: Path, scarid: Run) -> None:
    kind = name.split(".")[0]
    assert scarid("convert", name).out == (kept / f"{kind}.csv").read_text("utf-8")


@pytest.mark.parametrize("parameters", ["parameters.parquet", "parameters.csv"])
def test_parameters_mean_the_same_torques(parameters: str, kept: Path, scarid: Run) -> None:
    words = ("-q", "--parameters", parameters, "--predictions", "now.parquet")
    assert scarid("validate", *words, "motion.parquet").status == 0
    now, then = parquet.read_table("now.parquet"), parquet.read_table("prediction.parquet")
    assert now.column_names == then.column_names
    for column in then.column_names:
        np.testing.assert_allclose(now[column], then[column], rtol=1e-9, err_msg=column)


@pytest.mark.parametrize("version", VERSIONS)
def test_nothing_that_was_promised_is_gone(version: str) -> None:
    then = json.loads((HERE / version / "contract.json").read_text("utf-8"))
    now = contract()
    assert set(then["statuses"]) <= set(now["statuses"])
    for kind, columns in then["columns"].items():
        assert columns.items() <= now["columns"][kind].items(), kind
        new = now["columns"][kind].keys() - columns.keys()
        assert [name for name in new if now["columns"][kind][name]["required"]] == []
    for command, options in then["options"].items():
        for option, choices in options.items():
            assert set(choices) <= set(now["options"][command][option]), (command, option)
