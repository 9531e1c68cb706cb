"""Payloads that are picked up in a log, found by `scarid payload --trace`: `make bench-carried`.

Simulated arms, some with imperfections that no model has. The bare arm is identified from a motion
of 60 s. In another motion of 60 s it picks up .2 to 5 kg (log-uniform) at a time between 20 and
40 s. Told are: the share of the pick-ups that are suspected within 1 s, and that of those whose
time is known within 1 s (each pick-up on standard error), false changes in an hour of
motion, the median error of the mass, that of the centre, and how often mass and centre are within
their 95 % intervals.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from arms import URDFS, described
from contacts import CONDITIONS

import scarid

SECONDS, EARLY, LATE, WITHIN = 60.0, 20.0, 40.0, 1.0  # s
NEAR = 2.0  # s: a change at this distance is the one in question
LIGHT, HEAVY, AWAY = 0.2, 5.0, 0.1  # kg, kg, m
LAST = {"panda": "panda_link7", "ur10": "wrist_3_link", "xarm7": "link7"}  # as the simulator
PLACES = ("load_mass", "centre_x", "centre_y", "centre_z")


@dataclass
class Found:
    """What was found in the logs of one robot and condition."""

    within: list[bool] = field(default_factory=list)
    placed: list[bool] = field(default_factory=list)
    false: int = 0
    missed: int = 0
    masses: list[float] = field(default_factory=list)
    centres: list[float] = field(default_factory=list)
    inside: list[bool] = field(default_factory=list)

    def add(
        self, loads: list[dict[str, float | None]], at: float, mass: float, centre: np.ndarray
    ) -> None:
        """The pieces of a log in which this was picked up at this time [s]."""
        own = [x for x in loads[1:] if abs(x["t_start"] - at) <= NEAR]
        self.within.append(any(at <= x["t_found"] <= at + WITHIN for x in own))
        self.placed.append(any(abs(x["t_start"] - at) <= WITHIN for x in own))
        when = [f"at {x['t_start']:.2f} s, suspected {x['t_found']:.2f} s" for x in own]
        print(f"{mass:.2f} kg picked up at {at:.2f} s: {when or 'never'}", file=sys.stderr)
        self.missed += not own
        self.false += len(loads) - 1 - len(own[:1])
        last = loads[-1]
        self.masses.append(abs(last["load_mass"] / mass - 1.0))
        off = np.array([last[name] for name in PLACES[1:]], dtype=np.float64) - centre
        self.centres.append(float(np.linalg.norm(off)))
        halves = np.array([last[f"{name}_half"] for name in PLACES], dtype=np.float64)
        self.inside += (np.abs([last["load_mass"] - mass, *off]) <= halves).tolist()

    def row(self, name: str, condition: str) -> str:
        hours = len(self.within) * SECONDS / 3600.0
        mass, centre = 100 * np.median(self.masses), 1e3 * np.nanmedian(self.centres)
        told = f"{np.mean(self.within):.0%} | {np.mean(self.placed):.0%}"
        told += f" | {self.missed} | {self.false / hours:.1f}"
        known = f"{mass:.2g} % | {centre:.2g} mm | {np.mean(self.inside):.0%}"
        return f"| {name} | {condition} | {told} | {known} |"


def log(robot: str, seed: int, imperfections: tuple[str, ...]) -> scarid.Log:
    reference = scarid.trajgen(seed=seed, robot=robot, duration=SECONDS)
    return scarid.simulate(reference, seed=seed, robot=robot, with_=imperfections)


def judged(name: str, robot: str, condition: str, seeds: range, folder: Path) -> Found:
    found = Found()
    for seed in seeds:
        rng = np.random.default_rng(seed)
        mass = float(np.exp(rng.uniform(np.log(LIGHT), np.log(HEAVY))))
        centre, at = rng.uniform(-AWAY, AWAY, 3), rng.uniform(EARLY, LATE)
        moment = 0.001 * mass
        payload = (mass, *centre, moment, 0, 0, moment, 0, moment, at)
        words = CONDITIONS[condition]
        known = scarid.identify(log(robot, 1000 + seed, words), robot=robot)
        load = f"payload={','.join(map(str, payload))}"
        table = scarid.payload(
            log(robot, 2000 + seed, (*words, load)), parameters=known, robot=robot,
            frame=LAST[name], trace=folder / "trace.csv",
        )  # fmt: skip
        found.add(table.to_arrow().to_pylist(), at, mass, centre)
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=12)
    parser.add_argument("--robots", default="panda,ur10")
    parser.add_argument("--conditions", default=",".join(CONDITIONS))
    given = parser.parse_args()
    print(
        "| robot | condition | suspected within 1 s | time within 1 s | never | false in an hour "
        "| mass | centre | inside |"
    )
    print("|---|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for name in given.robots.split(","):
            robot = str(described(URDFS / f"{name}.urdf", Path(folder)))
            for condition in given.conditions.split(","):
                seeds = range(given.seeds)
                found = judged(name, robot, condition, seeds, Path(folder))
                print(found.row(name, condition), flush=True)


if __name__ == "__main__":
    main()
