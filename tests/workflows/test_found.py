"""What a batch says on its first screens of robots with something wrong."""

from __future__ import annotations

import re
import subprocess
import sys
from html import unescape
from pathlib import Path

import pytest
from fleet import Planned, changed, description, made
from workflows.outcomes import in_one_process

LOGS, GOOD = 6, 4
ROBOTS = {"robot1": "payload", "robot2": "drifting", "robot3": "reversed"}


def planned(robot: str, number: int) -> Planned:
    """A log; the last ones of robot1 have a payload, and the friction of robot2 grows."""
    friction = 1.0 + 0.6 * number / LOGS if robot == "robot2" else 1.0
    loaded = robot == "robot1" and number >= GOOD
    return Planned(robot, number, 40 * int(robot[-1]) + number, friction, loaded)


def reversed_joint(path: Path) -> None:
    """The log with the position of joint 2 reversed."""
    lines = path.read_text().splitlines(keepends=True)
    place = lines[0].split(",").index("q2")
    cells = (line.split(",")[place] for line in lines[1:])
    lines[1:] = [
        changed(line, {place: repr(-float(cell))})
        for line, cell in zip(lines[1:], cells, strict=True)
    ]
    path.write_text("".join(lines))


@pytest.fixture(scope="module")
def outcome(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("fleet")
    lines = ['out = "outcome"', 'pages = "needed"']
    for robot, name in ROBOTS.items():
        (folder / f"{name}.toml").write_text(description(robot))
        for number in range(LOGS):
            log = planned(robot, number)
            made(folder, log)
            if robot == "robot3" and number >= GOOD:
                reversed_joint(folder / "logs" / log.name)
        lines += [f"[robots.{name}]", f'robot = "{name}.toml"', f'logs = ["logs/{robot}/*.csv"]']
    (folder / "fleet.toml").write_text("\n".join(lines))
    done = in_one_process(folder / "fleet.toml")
    assert done.returncode == 0, done.stderr
    words = [sys.executable, "-m", "scarid_cli", "report", "--fleet", "outcome", "--html"]
    subprocess.run([*words, "outcome/fleet.html"], cwd=folder, check=True, capture_output=True)
    return folder / "outcome"


def words_of(html: str) -> str:
    return " ".join(unescape(re.sub(r"<[^>]*>", " ", html)).split())


def card(outcome: Path, robot: str) -> str:
    """What the page of the fleet says of a robot before its table of logs."""
    page = (outcome / "fleet.html").read_text("utf-8")
    cards = re.findall(r'<li class="card">.*?</li>', page, re.DOTALL)
    return next(words for each in cards if (words := words_of(each)).startswith(f"{robot} "))


@pytest.mark.parametrize(
    ("robot", "cause"),
    [
        ("payload", "another payload or set-up in 2 logs"),
        ("drifting", "friction of "),
        ("reversed", "position of joint 2 reversed in 2 logs"),
    ],
)
def test_the_page_of_the_fleet_names_the_cause_for_each_robot(
    robot: str, cause: str, outcome: Path
) -> None:
    assert cause in card(outcome, robot).partition("changed")[2]
    assert ("trend" in card(outcome, robot)) or robot == "reversed"


@pytest.mark.parametrize(
    ("robot", "cause"), [("payload", "another payload"), ("reversed", "position of joint 2")]
)
def test_the_page_of_a_log_says_on_its_first_screen_what_has_changed(
    robot: str, cause: str, outcome: Path
) -> None:
    pages = sorted((outcome / "logs" / robot).glob("*/report.html"))
    first = words_of(pages[-1].read_text("utf-8").partition("<nav")[0].partition("<header")[2])
    log = pages[-1].parent.name
    assert f"changed The robot of {log}.csv has changed" in first
    assert f"Yes. {log}.csv beside " in first
    assert cause in first
    assert "parameters.parquet" not in first


def test_amounts_are_never_cut_off(outcome: Path) -> None:
    page = (outcome / "fleet.html").read_text("utf-8")
    assert "line-clamp" not in page
    assert "text-overflow" not in page
