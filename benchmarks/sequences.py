"""Do three planned experiments of 10 s tell more than a random one of 60 s? By whole pipes.

    python benchmarks/sequences.py --planning "--starts 2 --criterion d --set interval=0.8"
    python benchmarks/sequences.py --robot samples/robots/ur10e.toml \\
      --home 0,-1.5708,0,-1.5708,0,0 --planning "--starts 1 --criterion d"

Each experiment after the first is planned by `trajgen --optimise --after` from the parameters that
the logs so far have given, all of them identified together. Both sides go through the same pipe.
Several plans, and as many random motions, are each simulated several times. The table has the
root-mean-square errors, estimate less true value, of each parameter.
"""

from __future__ import annotations

import argparse
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from shells import column, recorded, shell

from scarid_cli.algorithms.robots.reading import load
from scarid_cli.arrays import Array

ROOT = Path(__file__).parent.parent
EXPERIMENTS, SHORT, LONG = 3, 10.0, 60.0  # number of planned ones; durations [s]
# The logs of an experiment are a record with gaps. Each joint has its weight, and the delay of the
# torques is fitted.
IDENTIFY = (
    "scarid resample -q --rate 200 record.parquet | scarid differentiate -q --method {method} | "
    "scarid identify -q --robot {robot} --estimator wls --drop-slow 0.1 --align "
    "-o {table}.parquet; "
    "scarid convert -q {table}.parquet"
)


@dataclass(frozen=True)
class Study:
    """A robot (its name or path, and home position), and how its motions are planned and judged."""

    folder: Path
    robot: str
    home: str
    planning: str
    method: str

    def move(self, options: str, name: str) -> None:
        home = f"--home {self.home}" if self.home else ""
        shell(
            self.folder,
            f"scarid trajgen -q --robot {self.robot} {home} {options} -o {name}.parquet",
        )

    def errors(self, motions: list[str], seed: int, table: str) -> Array:
        """Estimates less true values, from logs of these motions, with noise of this seed."""
        logs = [self.folder / f"log-{motion}.parquet" for motion in motions]
        for i, (motion, log) in enumerate(zip(motions, logs, strict=True)):
            options = f"--robot {self.robot} --seed {EXPERIMENTS * seed + i} -o {log}"
            shell(self.folder, f"scarid simulate -q {options} {motion}.parquet")
        recorded(logs, self.folder / "record.parquet")
        found = shell(
            self.folder, IDENTIFY.format(robot=self.robot, method=self.method, table=table)
        )
        robot = load(self.robot)
        return column(found, "estimate", robot.names) - robot.apriori

    def planned(self, plan: int, runs: int) -> list[Array]:
        """The errors after three planned experiments."""
        after = ""
        names: list[str] = []
        for k in range(EXPERIMENTS):
            names.append(f"planned{k}")
            how = f"--optimise {self.planning} --duration {SHORT} --seed {plan}"
            self.move(f"{how} {after}", names[-1])
            after = "--after known.parquet"
            found = self.errors(names, runs * plan, "known")
        return [found, *(self.errors(names, runs * plan + n, "other") for n in range(1, runs))]

    def random(self, plan: int, runs: int) -> list[Array]:
        """The errors after one random experiment."""
        self.move(f"--duration {LONG} --seed {plan}", "random")
        return [self.errors(["random"], runs * plan + n, "other") for n in range(runs)]


def rms(errors: list[Array]) -> Array:
    return np.asarray(np.sqrt(np.mean(np.square(errors), axis=0)))


def compare(study: Study, plans: int, runs: int) -> None:
    planned, random = (
        rms([error for plan in range(plans) for error in side(plan, runs)])
        for side in (study.planned, study.random)
    )
    ratios = planned / random
    print(
        f"{study.robot}: errors after 3 planned experiments of 10 s, and after a random one of 60 s"
    )
    for row in zip(load(study.robot).names, planned, random, ratios, strict=True):
        print("{:8}{:12.3g}{:12.3g}{:8.2f}".format(*row))
    print(
        f"{plans * runs} runs; ratio: geometric mean {np.exp(np.log(ratios).mean()):.2f}, "
        f"{np.count_nonzero(ratios < 1.0)} of {len(ratios)} below 1, largest {ratios.max():.2f}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robot", default="scara2")
    parser.add_argument("--home", default="")
    parser.add_argument("--planning", default="--starts 2", help="options of `trajgen --optimise`")
    parser.add_argument("--method", default="zero-phase --set cutoff=20", help="of `differentiate`")
    parser.add_argument("--plans", type=int, default=5)
    parser.add_argument("--runs", type=int, default=4, help="of each plan")
    given = parser.parse_args()
    path = Path(given.robot)
    robot = str(path.resolve()) if path.exists() else given.robot
    with tempfile.TemporaryDirectory() as folder:
        study = Study(Path(folder), robot, given.home, given.planning, given.method)
        compare(study, given.plans, given.runs)


if __name__ == "__main__":
    main()
