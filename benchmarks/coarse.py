"""The choice of a bandwidth where positions are coarse: what it costs, and what it cost before.

`python benchmarks/coarse.py [--seeds 4]`: slow motions of 60 s (2 to 6 s between via points) at
100 Hz, controlled with perfect encoders and logged in steps. `chosen` is the cut-off [Hz], and
`error` the share of the variance of the torques that the errors of the parameters make there;
`scatter alone` is the choice that knows no bias, and `least` the least error of all cut-offs.
Medians over the seeds.
"""

from __future__ import annotations

import argparse
import io
from pathlib import Path
from tempfile import TemporaryDirectory
from unittest import mock

import numpy as np
import pyarrow.parquet as pq
from shells import shell

from scarid_cli.algorithms.filters.likelihood import noise_of
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.algorithms.tuning import scatter
from scarid_cli.algorithms.tuning.lowpassed import Segment, lowpassed
from scarid_cli.arrays import Array

HERE = Path(__file__).parent.parent
SAMPLE, PANDA = HERE / "samples/robots/ur10e.toml", HERE.parent / "shared/data/urdf/panda.urdf"
ROBOTS = {  # limits and home of the motion, and the noise [N m] of the torques
    "scara2": ("--dq-max 0.3 --ddq-max 1", 0.05),
    str(SAMPLE): ("--dq-max 0.3 --ddq-max 1 --home 0,-1.5708,0,-1.5708,0,0", 1.0),
    str(PANDA): ("--dq-max 0.15 --ddq-max 0.3 --home 0,-0.4,0,-2,0,1.6,0", 0.3),
}
STEPS = (0.001, 0.005, 0.02)  # rad


def logged(robot: Robot, name: str, seed: int) -> tuple[Segment, float]:
    """The log of a slow motion, and its period [s]."""
    motion, noise = ROBOTS[name]
    with TemporaryDirectory() as folder:
        shell(
            Path(folder),
            f"scarid trajgen -q --robot {name} --seed {seed} --duration 60 --segment 2 6 "
            f"{motion} | scarid simulate -q --robot {name} --seed {seed} --encoder-bits 0 "
            f"--torque-noise {noise} --log-rate 100 -o log.parquet",
        )
        table = pq.read_table(io.BytesIO((Path(folder) / "log.parquet").read_bytes()))
    joints = range(1, len(robot.joints) + 1)
    q, tau = (np.array([table[f"{x}{i}"].to_numpy() for i in joints]) for x in ("q", "tau"))
    return Segment(q, tau, np.zeros(len(q))), 0.01


def stepped(segment: Segment, step: float) -> Segment:
    """The segment with positions in steps [rad]."""
    q = np.round(segment.q / step) * step
    return Segment(q, segment.tau, np.array([noise_of(x) for x in q]))


def estimate(robot: Robot, segment: Segment, h: float, cutoff: float) -> scatter.Estimate | None:
    """The parameters behind a low-pass."""
    parts = [part for part in (lowpassed(segment, h, cutoff, robot.motors),) if part]
    return scatter.at_cutoff(robot, parts, cutoff, np.zeros(len(segment.q)), None)[1]


def errors(robot: Robot, fine: Segment, coarse: Segment, h: float) -> Array:
    """Cut-off and error of the choice, of the choice by scatter alone, and of the best cut-off."""
    points = scatter.curve(robot, [coarse], h)
    with mock.patch.object(scatter, "white", return_value=np.zeros(len(coarse.q))):
        alone = scatter.curve(robot, [coarse], h)
    at = sorted({point.cutoff for point in (*points, *alone)})
    clean = estimate(robot, fine, h, at[0])
    assert clean
    found = {}
    for cutoff in at:
        if (known := estimate(robot, coarse, h, cutoff)) is not None:
            off = known.theta - robot.apriori
            found[cutoff] = float(off @ clean.squares @ off)
    best = min(found, key=lambda cutoff: found[cutoff])
    choices = (scatter.chosen(points).cutoff, scatter.chosen(alone).cutoff, best)
    return np.array([(cutoff, found.get(cutoff, np.nan)) for cutoff in choices]).ravel()


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--seeds", type=int, default=4)
    seeds = range(1, parser.parse_args().seeds + 1)
    print("| robot | step [rad] | chosen | error | scatter alone | error | best | least |")
    print("|---|---|---|---|---|---|---|---|")
    for name in ROBOTS:
        if name == str(PANDA) and not PANDA.exists():
            continue
        robot = load(name)
        logs = [logged(robot, name, seed) for seed in seeds]
        for step in STEPS:
            rows = [errors(robot, log, stepped(log, step), h) for log, h in logs]
            cells = [f"{x:.2g}" for x in np.nanmedian(rows, axis=0)]
            print(f"| {Path(name).stem} | {step:g} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
