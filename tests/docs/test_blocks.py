"""Every shell block of the documentation runs, and prints what the page shows."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT, SHARED, Result
from docs.pages import PAGES, Block, blocks

from scarid_cli.algorithms.robots.reading import load

Shell = Callable[..., Result]

# The blocks that are run, by page.
RUN = {page: [block for block in blocks(page) if block.commands] for page in PAGES}
RUN = {page: found for page, found in RUN.items() if found}

# What pages call the reader's own files, and how to have something of that name.
OWN = {
    "log.csv": "cp samples/scara2.csv log.csv",
    "log.parquet": "scarid convert samples/scara2.csv -o log.parquet",
    "motion.csv": "scarid differentiate samples/scara2.csv -o motion.csv",
    "motion.parquet": "scarid differentiate samples/scara2.csv -o motion.parquet",
    "arm.toml": "cp samples/arm.toml arm.toml",
    "arm.urdf": "cp samples/arm.urdf arm.urdf",
}


def own_files(page: str, shell: Shell, folder: Path) -> None:
    """The working directory of a reader of the page: samples, real logs, and files of theirs."""
    shutil.copytree(ROOT / "samples", folder / "samples")
    (folder / "scarid_cli").symlink_to(ROOT / "scarid_cli")
    (folder / "DATA").mkdir()
    for path in (SHARED / "data").glob("*/*.*"):
        (folder / "DATA" / path.name).symlink_to(path)
    text = (ROOT / page).read_text("utf-8")
    for name in ("emps_train.csv", "emps_test_pulses.csv"):
        if name in text and (folder / "DATA" / name).exists():
            (folder / name).symlink_to(folder / "DATA" / name)
    made = [command for name, command in OWN.items() if name in text]
    assert shell(" && ".join(["true", *made])).status == 0
    if "recorder.csv" in text:
        recorder(folder)


def recorder(folder: Path) -> None:
    """A log of the motors of samples/arm.toml: angles in degrees, currents in mA."""
    robot = load(str(folder / "samples" / "arm.toml"))
    assert robot.log
    t = np.arange(2000) / 500.0
    rates = np.array([[2.0, 5.0, 9.0], [3.0, 7.0, 11.0]])
    q = sum(0.3 * np.sin(rates[:, [k]] * t + k) for k in range(3))
    dq, ddq = (np.gradient(np.gradient(q, t, axis=1), t, axis=1) if n else
               np.gradient(q, t, axis=1) for n in (0, 1))  # fmt: skip
    tau = robot.torques(robot.regressor(q, dq, ddq), robot.apriori)
    ratios = np.array(robot.log.ratios)
    angles = np.degrees(ratios @ (q - np.array(robot.log.zero)[:, None]))
    currents = 1e3 * np.linalg.solve(ratios.T, tau) / np.array(robot.log.constants)[:, None]
    table = np.vstack((angles, currents)).T
    header = "enc_a,enc_b,i_a,i_b"
    np.savetxt(folder / "recorder.csv", table, delimiter=",", header=header, comments="")


# A reader that has read enough would be an error in a shell that checks whole pipes.
START = 'set -e; head() { command head "$@"; cat > /dev/null; }'


def script(chosen: list[Block]) -> str:
    """The blocks one after the other in one shell, as a reader would type them."""
    parts = (
        f"exec >out.{block.line} 2>err.{block.line}\n{block.commands}\ntouch done.{block.line}"
        for block in chosen
    )
    return "\n".join((START, *parts))


def complaint(block: Block, folder: Path) -> str:
    """What is wrong with a block that was run, or nothing."""
    if not (folder / f"out.{block.line}").exists():
        return f"{block.place} was not reached"
    out, err = ((folder / f"{name}.{block.line}").read_text("utf-8") for name in ("out", "err"))
    if not (folder / f"done.{block.line}").exists():
        return f"{block.place} fails:\n{err}"
    if block.shown is not None and not block.prints(out, err):
        return f"{block.place} shows\n{block.shown}\nbut prints\n{err}{out}"
    return ""


def check(page: str, chosen: list[Block], shell: Shell, folder: Path) -> None:
    """Run these blocks of a page, as far as what they need is here, and compare."""
    runnable = [block for block in chosen if not block.lacks]
    own_files(page, shell, folder)
    shell(script(runnable))
    wrong = [text for text in (complaint(block, folder) for block in runnable) if text]
    assert not wrong, "\n\n".join(wrong)
    left = [block.lacks for block in chosen if block.lacks]
    if left:
        pytest.skip(f"{len(runnable)} blocks are as shown; {'; '.join(map(str, left))}")


@pytest.mark.parametrize("page", RUN)
def test_a_page_shows_what_its_commands_print(page: str, shell: Shell, tmp_path: Path) -> None:
    check(page, [block for block in RUN[page] if not block.slow], shell, tmp_path)


@pytest.mark.skipif(os.environ.get("SCARID_DOCS") != "all", reason="slow: make docs-test")
@pytest.mark.parametrize("page", [p for p, run in RUN.items() if any(b.slow for b in run)])
def test_a_page_with_slow_blocks_shows_it_too(
    page: str, users_shell: Shell, tmp_path: Path
) -> None:
    check(page, RUN[page], users_shell, tmp_path)


def test_most_blocks_are_run_and_many_are_compared() -> None:
    """So that a change of the rules in `pages` cannot quietly turn this module off."""
    run = [block for blocks_run in RUN.values() for block in blocks_run]
    assert len(run) >= 30
    assert len(run) >= 0.8 * sum(len(blocks(page)) for page in PAGES)
    assert sum(block.shown is not None for block in run) >= 10
    assert sum(block.slow for block in run) <= 0.1 * len(run)
