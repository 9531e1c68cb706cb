"""`scarid report --fleet`: what a batch found, in words and as a page."""

from __future__ import annotations

import re
from collections.abc import Callable
from html import unescape
from pathlib import Path

import fleets
import pytest
from conftest import Result, refused
from outcomes import done, estimate, failed, robot, write
from reports import markdown_rows

Run = Callable[..., Result]
RUDE = """</script><img src=x onerror=alert(1)><!--&amp;"'\u2028"""


@pytest.fixture
def outcome(tmp_path: Path) -> Path:
    return fleets.small(tmp_path / "outcome")


def page_of(folder: Path, scarid: Run) -> str:
    html = folder / "fleet.html"
    result = scarid("report", "--fleet", folder, "--html", html)
    assert (result.status, result.err) == (0, "")
    return html.read_text()


def static_rows(page: str) -> list[list[str]]:
    """The cells of the table for browsers without scripts, and for print."""
    table = page[page.index('<div id="static">') : page.index("<footer>")]
    rows = re.findall(r"<tr>(.*?)</tr>", table, re.DOTALL)
    cells = [re.findall(r"<t[dh][^>]*>(.*?)</t[dh]>", row, re.DOTALL) for row in rows[1:]]
    return [[unescape(re.sub("<.*?>", "", c)).strip() for c in row] for row in cells]


def test_failures_come_first_then_changes_then_doubts(outcome: Path, scarid: Run) -> None:
    page = page_of(outcome, scarid)
    assert static_rows(page) == [
        ["mixed", "2026-01-03", "failed: convert", "row 5: found 12 values"],
        ["drifting", "2026-01-03", "changed", "friction of joint 2"],
        ["mixed", "2026-01-02", "doubtful check: warning", "too slow"],
    ]
    logs = fleets.data(page)["logs"]
    order = sorted(range(9), key=lambda i: logs["place"][i])
    assert [logs["log"][i] for i in order[:3]] == ["2026-01-03", "2026-01-03", "2026-01-02"]
    assert logs["marks"][order[3]] == []


def test_the_summary_counts_findings_and_names_what_drifts(outcome: Path, scarid: Run) -> None:
    page = page_of(outcome, scarid)
    text = " ".join(unescape(re.sub("<.*?>", "", page[: page.index('<div id="live"')])).split())
    assert "3 logs of 9, of 2 of 3 robots, need a look." in text
    assert "Parameters of drifting have a trend." in text
    assert "1 failed 1 changed 1 verdict not good 1 check not ok 6 nothing found" in text
    assert "over the 3 tables, per table: Fs2 +0.1 N m (9 errors)" in text
    assert "Fs2 in 1, Fv1 in 1 (joint 2 in 1 log, joint 1 in 1 log)" in text
    assert "failed: convert in 1 log 2026-01-03: row 5: found 12 values" in text
    assert "1 robot without a finding steady (3 logs)" in text


def test_each_of_many_robots_that_need_a_look_has_one_card(tmp_path: Path, scarid: Run) -> None:
    names = [f"r{i:02d}" for i in range(30)]
    folder = fleets.write(
        tmp_path / "o",
        fleet=[fleets.failed(name, 1, "row 5: found 12 values") for name in names],
        estimates=[],
        robots=[fleets.robot(name) for name in names],
    )
    cards = re.findall(r'<li class="card">.*?<h3>(.*?)</h3>', page_of(folder, scarid), re.DOTALL)
    assert sorted(re.sub("<.*?>", "", card) for card in cards) == names


def test_the_script_is_given_the_estimates_with_their_intervals(outcome: Path, scarid: Run) -> None:
    found = fleets.data(page_of(outcome, scarid))
    drifting = found["robots"][1]
    assert (drifting["name"], drifting["trending"]) == ("drifting", ["Fs2"])
    history = drifting["parameters"][0]
    scale = 10 ** history["decimals"]
    assert [x / scale for x in history["estimate"]] == pytest.approx([1.1, 1.2, 1.3])
    assert [x / scale for x in history["half"]] == pytest.approx([0.02] * 3)
    logs = found["logs"]
    assert logs["apart"][3:6] == pytest.approx([7.1, 14.3, 21.4])
    assert logs["r2"][0] == [0.9991, 0.9982]
    assert logs["r2"][8] == []


def test_parameters_that_are_hardly_known_are_left_out(tmp_path: Path, scarid: Run) -> None:
    known = [estimate("r", i, "Fs1", 1.0) for i in (1, 2)]
    vague = [estimate("r", i, "Fv1", 1.0, robust_error=0.31) for i in (1, 2)]
    logs, robots = [done("r", 1), done("r", 2)], [robot("r")]
    folder = write(tmp_path / "o", fleet=logs, estimates=known + vague, robots=robots)
    parameters = fleets.data(page_of(folder, scarid))["robots"][0]["parameters"]
    assert [p["name"] for p in parameters] == ["Fs1"]


def test_text_from_the_tables_is_never_markup(tmp_path: Path, scarid: Run) -> None:
    reason = {"change": "changed", "change_reason": RUDE, "differing": RUDE, "page": RUDE}
    logs = [failed(RUDE, 1, RUDE), done(RUDE, 2, log=RUDE, **reason)]
    estimates = [estimate(RUDE, 2, RUDE, 1.0, unit=RUDE)]
    robots = [robot(RUDE, trend=RUDE, trending=RUDE)]
    folder = write(tmp_path / "o", fleet=logs, estimates=estimates, robots=robots)
    html = folder / "fleet.html"
    result = scarid("report", "--fleet", folder, "--html", html, "--title", RUDE)
    assert result.status == 0
    page = html.read_text()
    assert "<img" not in page
    assert "<!--" not in page
    assert page.count("</script>") == 2
    found = fleets.data(page)
    assert found["robots"][0]["name"] == found["logs"]["log"][1] == RUDE
    assert found["logs"]["notes"][1][0] == ["validate", RUDE]


def test_nothing_is_loaded_from_elsewhere(outcome: Path, scarid: Run) -> None:
    (outcome / "fleet.tsv").write_text("robot\n")
    page = page_of(outcome, scarid)
    links = set(re.findall(r'(?:href|src|action)="(.*?)"', page))
    assert links == {"#logs", "./fleet.tsv", "./logs/drifting/3/report.html"}
    assert "default-src 'none'" in page
    assert not re.search(r"fetch\(|import\(|XMLHttpRequest|url\(|@import", page)


def test_a_page_of_a_log_is_always_below_the_folder(tmp_path: Path, scarid: Run) -> None:
    logs = [
        done("r", 1, page="javascript:alert(1)"),
        done("r", 2, page="//a.b/c"),
    ]
    folder = write(tmp_path / "o", fleet=logs, estimates=[], robots=[robot("r")])
    found = fleets.data(page_of(folder, scarid))["logs"]["page"]
    assert found == ["./javascript%3Aalert%281%29", ".///a.b/c"]


def test_links_lead_from_where_the_page_is(outcome: Path, tmp_path: Path, scarid: Run) -> None:
    (tmp_path / "pages").mkdir()
    html = tmp_path / "pages" / "fleet.html"
    assert scarid("report", "--fleet", outcome, "--html", html).status == 0
    assert "../outcome/logs/drifting/3/report.html" in html.read_text()


def test_the_same_bytes_twice(outcome: Path, scarid: Run) -> None:
    assert page_of(outcome, scarid) == page_of(outcome, scarid)


def test_a_fleet_of_failures_has_a_page(tmp_path: Path, scarid: Run) -> None:
    logs = [failed("r", i, "scarid convert: a.csv: no such file") for i in (1, 2)]
    folder = write(tmp_path / "o", fleet=logs, estimates=[], robots=[robot("r")])
    page = page_of(folder, scarid)
    assert len(static_rows(page)) == 2
    assert fleets.data(page)["robots"][0]["parameters"] == []


def test_the_terminal_and_markdown_say_what_needs_a_look(outcome: Path, scarid: Run) -> None:
    result = scarid("report", "--fleet", outcome)
    assert (result.status, result.err) == (0, "")
    listed = result.out.partition("Logs that need a look")[2]
    assert listed.index("failed: convert") < listed.index("friction of joint 2")
    causes = result.out.partition("What has changed")[2].partition("Logs that need a look")[0]
    assert "friction of joint 2 in" in causes
    rows = markdown_rows(scarid("report", "--fleet", outcome, "--markdown", "-").out)
    assert [row for row in rows if row[0] == "drifting"] == [
        ["drifting", "3", "0", "1", "0", "0", "2", "Fs2"],
        ["drifting", "friction of joint 2 in 1 log"],
        ["drifting", "2026-01-03", "changed", "friction of joint 2"],
    ]


@pytest.mark.parametrize("name", ["fleet", "estimates", "robots"])
def test_a_folder_that_lacks_a_table_is_refused(name: str, outcome: Path, scarid: Run) -> None:
    (outcome / f"{name}.parquet").unlink()
    refused(scarid("report", "--fleet", outcome), 2, f"{outcome}: no {name}.parquet in it")


def test_a_table_of_another_kind_is_refused(outcome: Path, scarid: Run) -> None:
    (outcome / "robots.parquet").rename(outcome / "fleet.parquet")
    write(outcome, robots=[robot("r")])
    refused(scarid("report", "--fleet", outcome), 65, "fleet.parquet, column log")


def test_an_empty_fleet_is_refused(tmp_path: Path, scarid: Run) -> None:
    folder = write(tmp_path / "o", fleet=[], estimates=[], robots=[])
    refused(scarid("report", "--fleet", folder), 65, "fleet.parquet", "no rows")


def test_files_and_options_of_other_reports_are_refused(outcome: Path, scarid: Run) -> None:
    table = outcome / "fleet.parquet"
    refused(scarid("report", "--fleet", outcome, table), 2, str(table))
    refused(scarid("report", "--fleet", outcome, "--repeated"), 2, "--repeated")
    refused(scarid("report", "--fleet", outcome, "--figures", "x"), 2, "--figures")
    pair = ("--html", "x", "--markdown", "x")
    refused(scarid("report", "--fleet", outcome, *pair), 2, "two files")
