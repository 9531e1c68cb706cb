"""A simulated fleet: `python benchmarks/fleet.py FOLDER [LOGS]` writes logs and a configuration.

Robots are SCARAs with parameters of their own, and every log follows a motion of its own. Of a
thousand logs forty are spoiled and twenty have another payload; the friction of one robot drifts.
What is wrong with which log is in FOLDER/truth.json. The same numbers give the same logs; logs that
are there already are kept.
"""

from __future__ import annotations

import contextlib
import io
import json
import re
import sys
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from datetime import date, timedelta
from pathlib import Path

import numpy as np

from scarid_cli.__main__ import main
from scarid_cli.algorithms.robots import reading

ROBOTS = 4
SPOILED, PAYLOAD = 0.04, 0.02  # of all logs
DRIFTING, DRIFT = "robot2", 0.5  # friction at the end, relative to the start, of one robot
SPREAD = 0.2  # of the parameters of a robot about those of the paper
LOAD = {"ZZ1R": 0.05, "ZZ2": 0.02, "L1MX2": 0.04}  # kg m2, added by the payload
FRICTION = ("Fv1", "Fs1", "Fv2", "Fs2")
SPOILS = ("text", "cut", "frozen", "swapped", "degrees", "empty")
START = date(2026, 1, 1)


@dataclass(frozen=True)
class Planned:
    """A log of the fleet: its robot, its number there, and what is done to it."""

    robot: str
    number: int
    seed: int
    friction: float = 1.0
    payload: bool = False
    spoil: str = ""

    @property
    def name(self) -> str:
        day = START + timedelta(days=self.number)
        return f"{self.robot}/{day:%Y-%m-%d}.csv"


def planned(logs: int) -> Iterator[Planned]:
    """The logs of a fleet of this size."""
    rng = np.random.default_rng(17)
    faulty = rng.permutation(logs)
    spoiled = set(faulty[: round(SPOILED * logs)].tolist())
    loaded = set(faulty[len(spoiled) : len(spoiled) + round(PAYLOAD * logs)].tolist())
    per_robot = -(-logs // ROBOTS)
    for i in range(logs):
        robot, number = f"robot{i % ROBOTS + 1}", i // ROBOTS
        friction = 1.0 + DRIFT * number / per_robot if robot == DRIFTING else 1.0
        spoil = SPOILS[i % len(SPOILS)] if i in spoiled else ""
        yield Planned(robot, number, i, friction, i in loaded, spoil)


def description(robot: str, *, friction: float = 1.0, payload: bool = False) -> str:
    """The description of a robot, with parameters of its own."""
    rng = np.random.default_rng([17, int(robot.removeprefix("robot"))])
    text = (Path(reading.__file__).parent / "scara2.toml").read_text("utf-8")
    blocks = text.split("[[parameter]]")
    for k, block in enumerate(blocks[1:], start=1):
        name = block.split('name = "')[1].split('"')[0]
        value = float(block.split("apriori = ")[1].split()[0])
        own = value * float(rng.uniform(1.0 - SPREAD, 1.0 + SPREAD))
        own = own * friction if name in FRICTION else own + payload * LOAD.get(name, 0.0)
        blocks[k] = re.sub(r"apriori = \S+", f"apriori = {own!r}", block)
    return "[[parameter]]".join(blocks)


def made(folder: Path, log: Planned) -> None:
    """Simulate a log, unless it is there."""
    place = folder / "logs" / log.name
    if place.exists():
        return
    place.parent.mkdir(parents=True, exist_ok=True)
    own = folder / "simulated" / f"{log.seed}.toml"
    own.parent.mkdir(exist_ok=True)
    own.write_text(description(log.robot, friction=log.friction, payload=log.payload))
    words = ["trajgen", "-q", "--seed", str(log.seed), "--robot", str(own), "then", "simulate"]
    raw = own.with_suffix(".csv")
    words += ["--robot", str(own), "--seed", str(log.seed), "-q", "-o", str(raw)]
    with contextlib.redirect_stderr(io.StringIO()) as said:
        status = main(words)
    if status:
        raise RuntimeError(f"{log.name}: {said.getvalue()}")
    lines = raw.read_text().splitlines(keepends=True)
    (place.with_suffix(".part")).write_text("".join(spoilt(lines, log.spoil)))
    place.with_suffix(".part").replace(place)
    own.unlink()
    raw.unlink()


def spoilt(lines: list[str], how: str) -> list[str]:
    """The lines of a log (t, q1, q2, tau1, tau2, ...) after a mishap."""
    middle = len(lines) // 2
    if how == "text":
        lines[middle] = lines[middle].replace(",", ",Error,", 1)
    elif how == "cut":
        lines = [*lines[:middle], lines[middle][:20]]
    elif how == "empty":
        lines = lines[:1]
    elif how == "frozen":
        lines[1:] = [changed(line, {1: "0.25"}) for line in lines[1:]]
    elif how == "swapped":
        lines[1:] = [reordered(line, (0, 1, 2, 4, 3)) for line in lines[1:]]
    elif how == "degrees":
        lines[1:] = [scaled(line, (1, 2), 180.0 / np.pi) for line in lines[1:]]
    return lines


def changed(line: str, values: dict[int, str]) -> str:
    cells = line.rstrip("\n").split(",")
    return ",".join(values.get(i, cell) for i, cell in enumerate(cells)) + "\n"


def reordered(line: str, order: tuple[int, ...]) -> str:
    cells = line.rstrip("\n").split(",")
    return ",".join([*(cells[i] for i in order), *cells[len(order) :]]) + "\n"


def scaled(line: str, columns: tuple[int, ...], factor: float) -> str:
    cells = line.rstrip("\n").split(",")
    return changed(line, {i: repr(float(factor * float(cells[i]))) for i in columns})


def configuration(group: int, pages: str) -> str:
    """The configuration of the fleet's batch."""
    names = [f"robot{i + 1}" for i in range(ROBOTS)]
    robots = (
        f'[robots.{name}]\nrobot = "{name}.toml"\nlogs = ["logs/{name}/*.csv"]\n' for name in names
    )
    return "\n".join([f'out = "outcome"\ngroup = {group}\npages = "{pages}"\n', *robots])


def fleet(folder: Path, logs: int, *, group: int = 25, pages: str = "needed") -> Path:
    """Write a fleet, and return its configuration."""
    folder.mkdir(parents=True, exist_ok=True)
    for i in range(ROBOTS):
        (folder / f"robot{i + 1}.toml").write_text(description(f"robot{i + 1}"))
    listed = list(planned(logs))
    with ProcessPoolExecutor() as pool:
        list(pool.map(made, [folder] * logs, listed, chunksize=8))
    truth = {log.name: asdict(log) for log in listed}
    (folder / "truth.json").write_text(json.dumps(truth, indent=1) + "\n")
    config = folder / "fleet.toml"
    config.write_text(configuration(group, pages))
    return config


if __name__ == "__main__":
    print(fleet(Path(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 1000))
