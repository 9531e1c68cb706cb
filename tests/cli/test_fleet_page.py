"""`scarid report --fleet`: one row a log, failures first, and the course of each parameter."""

from __future__ import annotations

import json
import re
import xml.etree.ElementTree as ET
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from conftest import Result, refused
from reports import page_of

from scarid_cli.io.table import METADATA_KEY, Metadata
from scarid_cli.reporting.fleet.reading import STATES, state
from scarid_cli.reporting.fleet.sparkline import HEIGHT, MARKS, MOST, limits, sparkline

Run = Callable[..., Result]
RUDE = '<script>alert("&")</script>'
PARAMETERS = ("ZZ1R", "Fv1")


def log(robot: str, order: int, **given: Any) -> dict[str, Any]:
    name = f"2026-01-{order:02}"
    usual = {
        "robot": robot, "log": name, "file": f"logs/{robot}/{name}.csv", "date": name,
        "order": order, "status": 0, "step": None, "error": None, "check": "ok", "findings": "",
        "verdict": "good", "reasons": "2 of 2 parameters known within 30 %", "samples": 400,
        "condition_number": 12.0, "delay": 0.0005, "delay_error": 0.0001, "r2_1": 0.9991,
        "r2_2": 0.9982, "reference": "2026-01-01", "r2_validated_1": 0.99, "r2_validated_2": 0.98,
        "change": "unchanged", "change_reason": "no change", "compare": "agrees", "differing": None,
        "p_value": 1.0, "page": f"logs/{robot}/{name}/report.html",
    }  # fmt: skip
    return usual | given


def estimate(row: dict[str, Any], parameter: str, value: float) -> dict[str, Any]:
    return {
        **{key: row[key] for key in ("robot", "log", "order", "date")},
        "parameter": parameter, "unit": "kg m2", "estimate": value, "robust_error": 0.01,
        "low": value - 0.02, "high": value + 0.02, "errors": 0.0, "p_value": 1.0,
    }  # fmt: skip


def failed(robot: str, order: int) -> dict[str, Any]:
    nothing = dict.fromkeys(
        ("check", "verdict", "reasons", "delay", "delay_error", "r2_1", "r2_2", "change",
         "change_reason", "compare", "page", "r2_validated_1", "r2_validated_2", "p_value")
    )  # fmt: skip
    error = f"scarid convert: row 5: {RUDE}"
    return log(robot, order, status=65, step="convert", error=error, **nothing)


def write(folder: Path, name: str, rows: list[dict[str, Any]]) -> None:
    meta = {METADATA_KEY: Metadata(kind=name).to_json()}
    pq.write_table(
        pa.Table.from_pylist(rows).replace_schema_metadata(meta), folder / f"{name}.parquet"
    )


def robot(name: str, trending: str | None = None) -> dict[str, Any]:
    trend = "trend over the 9 tables: ZZ1R" if trending else "no trend over the 9 tables"
    return {
        "robot": name, "description": "scara2", "logs": 9, "identified": 8, "failed": 1,
        "reference": "2026-01-01", "cutoff": 8.0, "tuned_on": "2026-01-01", "trend": trend,
        "trending": trending,
    }  # fmt: skip


@pytest.fixture
def outcome(tmp_path: Path) -> Path:
    """Nine logs of two robots: one failed, one changed, one doubtful, one with a finding."""
    folder = tmp_path / "outcome"
    folder.mkdir()
    rows = [log("b", k) for k in range(1, 10)] + [log("a", k) for k in range(1, 10)]
    rows[10] |= failed("a", 2)
    differs = {"change": "changed", "change_reason": "another payload", "compare": "differs"}
    rows[12] |= {**differs, "differing": "ZZ1R"}
    rows[3] |= {"verdict": "doubtful", "reasons": "the estimates depend on the soft sensor"}
    rows[5] |= {"check": "warning", "findings": "clock: 3 % jitter"}
    values = {row["log"] + row["robot"]: 3.0 + 0.01 * i for i, row in enumerate(rows)}
    estimates = [
        estimate(row, p, values[row["log"] + row["robot"]])
        for row in rows if not row["status"] for p in PARAMETERS
    ]  # fmt: skip
    write(folder, "fleet", rows)
    write(folder, "estimates", estimates)
    write(folder, "robots", [robot("b"), robot("a", "ZZ1R")])
    return folder


def data_of(html: str) -> dict[str, Any]:
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', html, re.DOTALL)
    assert found
    loaded: dict[str, Any] = json.loads(found[1])
    return loaded


def test_failures_come_first_then_changes_doubts_and_findings(outcome: Path, scarid: Run) -> None:
    html = outcome / "fleet.html"
    result = scarid("report", "--fleet", outcome, "--html", html)
    assert (result.status, result.err) == (0, "")
    states = [row[0] for row in data_of(html.read_text("utf-8"))["rows"]]
    assert states[:4] == ["failed", "changed", "doubted", "noticed"]
    assert set(states[4:]) == {"fine"}
    assert len(states) == 18
    assert "18 logs of 2 robots: 1 failed, 1 changed, 1 not good" in page_of(html).text
    assert "18 logs of 2 robots: 1 failed" in result.out
    assert "another payload" in result.out


def test_the_rows_hold_what_the_tables_say(outcome: Path, scarid: Run) -> None:
    html = outcome / "fleet.html"
    scarid("report", "--fleet", outcome, "--html", html)
    data = data_of(html.read_text("utf-8"))
    changed = next(row for row in data["rows"] if row[0] == "changed")
    cells = dict(zip(data["headers"], changed[1], strict=True))
    assert (cells["robot"], cells["log"], cells["verdict"]) == ("a", "2026-01-04", "good")
    assert (cells["R2"], cells["delay [ms]"]) == ("0.9991 0.9982", "0.50 ± 0.10")
    assert cells["parameters"].startswith("ZZ1R 3.12 ± 0.02")
    assert cells["remark"] == "another payload"
    assert changed[2] == "logs/a/2026-01-04/report.html"


def test_the_page_is_self_contained_and_escapes_what_a_log_says(outcome: Path, scarid: Run) -> None:
    pages = [outcome / name for name in ("one.html", "two.html")]
    for html in pages:
        assert scarid("report", "--fleet", outcome, "--html", html).status == 0
    first, second = (html.read_text("utf-8") for html in pages)
    assert first == second
    assert "<script>alert" not in first
    assert not re.search(r"https?:|@import|fetch\(|XMLHttp", first)
    page = page_of(pages[0])
    assert {"link", "img", "iframe"}.isdisjoint(page.tags)
    anchors = [r[1:] for r in page.references if r.startswith("#")]
    assert set(anchors) <= set(page.ids)
    assert data_of(first)["rows"][0][1][8] == f"scarid convert: row 5: {RUDE}"
    # The first rows stand in the document itself, for print and for browsers without scripts.
    assert len(page.rows) == 1 + 18


def test_links_lead_from_the_page_to_the_outcome(
    outcome: Path, tmp_path: Path, scarid: Run
) -> None:
    html = tmp_path / "pages" / "fleet.html"
    html.parent.mkdir()
    assert scarid("report", "--fleet", outcome, "--html", html).status == 0
    links = [row[2] for row in data_of(html.read_text("utf-8"))["rows"] if row[2]]
    assert len(links) == 17
    assert all(link.startswith("../outcome/logs/") for link in links)


def test_every_sparkline_has_a_name_and_a_red_point_for_each_log_that_differs(
    outcome: Path, scarid: Run
) -> None:
    html = outcome / "fleet.html"
    scarid("report", "--fleet", outcome, "--html", html)
    sparks = re.findall(r'<svg [^>]*class="spark">.*?</svg>', html.read_text("utf-8"), re.DOTALL)
    assert len(sparks) == 4  # two robots, two parameters
    assert all('role="img"' in spark and 'aria-label="' in spark for spark in sparks)
    (marked,) = [spark for spark in sparks if 'class="outlier"' in spark]
    assert "ZZ1R over 8 logs, 1 of which differ" in marked
    assert "<title>2026-01-04: 3.12</title>" in marked
    text = html.read_text("utf-8")
    assert text.index('data-robot="a"') < text.index('data-robot="b"')  # a needs a look


def test_one_strange_log_does_not_flatten_the_drift_of_the_others() -> None:
    drift = 1.0 + 0.01 * np.arange(20)
    values = np.array([np.arange(20), drift, drift - 0.01, drift + 0.01])
    usual = limits(values)
    values[1:, -1] = 50.0
    low, high = limits(values)
    assert high < 1.1 * usual[1]
    assert low < 1.0 < 1.18 < high


def test_a_course_of_many_logs_stays_small() -> None:
    rows = [estimate(log("a", k), "p", 1.0 + np.sin(k / 50.0)) for k in range(1, 2001)]
    drawn = ET.fromstring(sparkline(rows, {row["log"] for row in rows}))
    course = next(p for p in drawn.iter("path") if p.get("class") == "course")
    places = re.findall(r"[\d.]+", course.get("d") or "")
    assert len(places) == 2 * MOST
    assert all(0.0 <= float(y) <= HEIGHT for y in places[1::2])
    assert len([*drawn.iter("circle")]) == MARKS


def test_every_state_has_words() -> None:
    rows = [log("a", 1), log("a", 1, check="failed"), log("a", 1, verdict="doubtful")]
    rows += [log("a", 1, compare="differs"), log("a", 1, change="unexplained"), failed("a", 1)]
    found = [state(row) for row in rows]
    assert found == ["fine", "noticed", "doubted", "changed", "changed", "failed"]
    assert set(found) == set(STATES)


def test_ten_thousand_logs_make_a_page_in_bounded_time(tmp_path: Path, scarid: Run) -> None:
    rows = [log(f"r{k % 50}", k // 50 + 1) for k in range(10_000)]
    rows[0] |= failed("r0", 1)
    rows[1] |= {"compare": "differs", "differing": "p"}
    write(tmp_path, "fleet", rows)
    write(tmp_path, "estimates", [estimate(row, "p", 1.0) for row in rows[1:]])
    write(tmp_path, "robots", [robot(f"r{k}", "p" if k == 7 else None) for k in range(50)])
    html = tmp_path / "fleet.html"
    assert scarid("report", "-q", "--fleet", tmp_path, "--html", html).status == 0
    assert html.stat().st_size < 8_000_000
    assert len(data_of(html.read_text("utf-8"))["rows"]) == 10_000
    assert page_of(html).tags.count("tr") == 101


def test_what_cannot_stand_beside_a_fleet_is_refused(outcome: Path, scarid: Run) -> None:
    table = outcome / "fleet.parquet"
    refused(scarid("report", "--fleet", outcome, table), 2, "--fleet", str(table))
    refused(scarid("report", "--fleet", outcome, "--repeated"), 2, "--fleet", "--repeated")
    refused(scarid("report", "--fleet", outcome / "no"), 2, "no such file", "fleet.parquet")
