"""`scarid report --repeated --html`: the page begins with the answer, then has contents."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from conftest import Result
from reports import page_of

Run = Callable[..., Result]


def test_the_page_of_repetitions_begins_with_the_best_method(
    scarid: Run, samples: Path, tmp_path: Path
) -> None:
    for seed in ("1", "2"):
        folder = tmp_path / seed
        folder.mkdir()
        for name, options in (("worst", ("--all-rows", "--estimator", "ls")), ("best", ())):
            motion, table = folder / "motion.parquet", folder / f"{name}.parameters.parquet"
            method = ("--method", "kalman") if name == "best" else ("--method", "2smd")
            words = (*method, samples / "scara2.csv", "-o", motion)
            assert scarid("differentiate", *words).status == 0
            words = ("--robot", "scara2", *options, motion, "-o", table)
            assert scarid("identify", *words).status == 0
    html = tmp_path / "report.html"
    result = scarid("report", "--repeated", *sorted(tmp_path.glob("*/*.parameters.parquet")),
                    "--html", html)  # fmt: skip
    assert result.status == 0, result.err
    page = html.read_text("utf-8")
    assert "best is the best of 2 methods over 2 experiments" in page
    assert page.index('class="headline"') < page.index('aria-label="Contents"')
    assert page.index(">best</th>") < page.index(">worst</th>")
    anchors = [r.removeprefix("#") for r in page_of(html).references if r.startswith("#")]
    assert set(anchors) <= set(page_of(html).ids)
