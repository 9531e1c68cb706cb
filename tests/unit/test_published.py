"""The paper's printed values: none mistyped, and shown beside ours."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from conftest import Result

ROOT = Path(__file__).parents[2]
FILE = ROOT / "samples" / "paper" / "published.csv"
PAPER = ROOT.parent / "shared" / "paper.txt"
ROWS = list(csv.DictReader(FILE.read_text("utf-8").splitlines()))
LABELS = {"ed-fir": "ED+FIR", "2smd": "2SMD", "astd": "ASTD", "p2smd": "P2SMD"}
PARAMETERS = ["ZZ1R", "Fv1", "Fs1", "ZZ2", "L1MX2", "L1MY2", "Fv2", "Fs2"]


@pytest.fixture(scope="module")
def tables() -> dict[str, list[list[str]]]:
    """The cells of each table of the paper, row by row."""
    if not PAPER.is_file():
        pytest.skip(f"{PAPER.name} is not there")
    found: dict[str, list[list[str]]] = {}
    current: list[list[str]] = []
    for line in PAPER.read_text("utf-8").splitlines():
        title = re.match(r"Table (\d)\. ", line)
        if title:
            current = found.setdefault(title[1], [])
        elif "\t" in line:
            current.append([cell.replace(" ", "") for cell in line.split("\t")])
    return found


def row_of(table: list[list[str]], label: str) -> list[str]:
    return next(row for row in table if row[0].startswith(label))


def printed(table: str) -> list[dict[str, str]]:
    return [row for row in ROWS if row["table"] == table]


def test_every_method_and_parameter_of_the_paper_is_there() -> None:
    assert {row["method"] for row in ROWS} == {*LABELS, "a priori"}
    for table in ("2", "3"):
        assert {row["quantity"] for row in printed(table)} == set(PARAMETERS)
    assert len(printed("2")) == 8 + 4 * 16 - 1  # one estimate of ASTD is not legible
    assert (len(printed("3")), len(printed("4")), len(printed("5"))) == (32, 16, 16)


def test_settings_are_those_of_table_1(tables: Any) -> None:
    for row in printed("1"):
        text = row_of(tables["1"], LABELS[row["method"]])[1]
        plain = re.sub(r"[\\_{}$]", "", text).lower().replace("varepsilon", "epsilon")
        settings = dict(re.findall(r"([a-z]\w*)=(\d+(?:\.\d+)?)", plain))
        settings |= dict(
            zip(("order", "cutoff"), re.findall(r"(\d+)(?:th|hz)", plain), strict=False)
        )
        assert settings[row["quantity"]] == row["value"]


def test_estimates_are_those_of_table_2(tables: Any) -> None:
    rows = dict(zip(PARAMETERS, tables["2"][1:9], strict=True))
    for row in printed("2"):
        cells = rows[row["quantity"]]
        if row["method"] == "a priori":
            at = 1
        else:
            at = 2 + 2 * list(LABELS).index(row["method"]) + (row["measure"] != "estimate")
        assert cells[at] == row["value"]


def test_parameter_errors_are_those_of_table_3(tables: Any) -> None:
    for row in printed("3"):
        cells = row_of(tables["3"], LABELS[row["method"]])
        assert cells[1 + PARAMETERS.index(row["quantity"])] == row["value"]


@pytest.mark.parametrize(("table", "experiment"), [("4", "direct"), ("5", "cross")])
def test_torque_errors_are_those_of_tables_4_and_5(
    table: str, experiment: str, tables: Any
) -> None:
    for row in printed(table):
        cells = row_of(tables[table], LABELS[row["method"]])
        at = 1 + 2 * (row["quantity"] == "tau2") + (row["measure"] == "rmse")
        assert cells[at] == row["value"]
        assert row["experiment"] == experiment


def test_published_values_stand_beside_ours_as_they_were_printed(
    shell: Callable[..., Result], samples: Path
) -> None:
    result = shell(
        f"scarid differentiate {samples}/scara2.csv -o p2smd.direct.motion.parquet;"
        " scarid identify -q p2smd.direct.motion.parquet -o p2smd.parameters.parquet"
        " --trace p2smd.trace.parquet;"
        " scarid validate --parameters p2smd.parameters.parquet p2smd.direct.motion.parquet"
        " -o p2smd.direct.metrics.parquet;"
        f" scarid report p2smd.*parquet --published {FILE} --html r.html --figures figures;"
        " ls figures"
    )
    assert result.status == 0, result.err
    for cell in ("p2smd, published", "3.34", "0.9604", "0.9215", "0.2797", "gamma0 = 25"):
        assert cell in result.out
    assert "01-soft-sensors-direct-1.svg" in result.out


def test_repetitions_become_medians_quartiles_and_rankings(
    shell: Callable[..., Result], samples: Path
) -> None:
    """Three runs that differ in one setting; the ranking of two methods against the paper's."""
    script = "".join(
        f"mkdir -p {k};"
        f" scarid differentiate --method p2smd --set gamma1={gain} --no-match {samples}/scara2.csv"
        f" -o {k}/motion.parquet;"
        f" scarid identify -q {k}/motion.parquet -o {k}/p2smd.parameters.parquet;"
        f" for m in p2smd 2smd; do scarid validate --parameters {k}/p2smd.parameters.parquet"
        f" {k}/motion.parquet -o {k}/$m.direct.metrics.parquet; done;"
        for k, gain in enumerate((18, 20, 25))
    )
    result = shell(
        f"{script} scarid report --repeated */*.parameters.parquet;"
        f" scarid report --repeated --published {FILE} */*.metrics.parquet;"
        " for k in 0 1 2; do scarid validate --parameters $k/p2smd.parameters.parquet"
        " $k/motion.parquet | sed -n 2p | cut -d, -f2; done"
    )
    assert result.status == 0, result.err
    assert "Median [first quartile, third quartile] of 3 experiments." in result.out
    middle = sorted(map(float, result.out.split()[-3:]))[1]
    assert f"{middle:#.4g}" in result.out
    assert "p2smd < 2smd" in result.out
