"""Arms known by their URDF alone: planned, simulated and identified, in one pipe each.

    python benchmarks/arms.py --seeds 5

The URDFs are those in ../shared/data/urdf. They have no motors and no friction; a description gives
each joint an inertia of the motor, viscous and Coulomb friction as shares of its torque limit. The
table has the processor time of each command, the errors (estimate less true value) in units of the
stated robust errors, over all estimates of several motions, and how many are beyond three.
"""

from __future__ import annotations

import argparse
import tempfile
from math import pi
from pathlib import Path

import numpy as np
from shells import column, shell

from scarid_cli.algorithms.robots.reading import load
from scarid_cli.arrays import Array

URDFS = Path(__file__).parent.parent.parent / "shared/data/urdf"
ARMS = ("panda", "ur10", "xarm7", "so101")
ACCELERATION = 5.0  # rad/s2, the limit
INERTIA, VISCOUS, COULOMB = 0.1, 0.05, 0.05  # of the torque limit, at the largest ddq and dq
NOISE = 0.003  # of the torque limit
RESOLUTION = 2.0 * pi / 2.0**17
TIMED = 'TIMEFORMAT="{name} %U"; {{ time {command} 2> /dev/null; }} 2>> times'
STEPS = {
    "trajgen": "scarid trajgen --robot arm.toml --optimise --starts 2 --seed {seed} --format arrow",
    "simulate": "scarid simulate --robot arm.toml --seed {seed} --format arrow",
    "identify": "scarid identify --robot arm.toml",
}


def described(urdf: Path, folder: Path) -> Path:
    """A description of the arm, with motors and friction."""
    arm = load(str(urdf))
    assert arm.body
    lines = [f"title = '{urdf.stem}'", f"urdf = '{urdf}'"]
    for name, joint in zip(arm.body.joint_names, arm.joints, strict=True):
        most = joint.torque_limit
        shares = (INERTIA / ACCELERATION, VISCOUS / joint.velocity_limit, COULOMB)
        inertia, viscous, coulomb = (most * share for share in shares)
        lines += [
            "[[joint]]",
            f"name = '{name}'",
            f"acceleration_limit = {ACCELERATION}",
            f"encoder_resolution = {RESOLUTION}",
            f"torque_noise = {NOISE * most}",
            f"terms = {{ inertia = {inertia}, viscous = {viscous}, coulomb = {coulomb}, "
            "offset = 0.0 }",
        ]
    path = folder / "arm.toml"
    path.write_text("\n".join(lines))
    return path


def pipe(folder: Path, seed: int) -> tuple[str, dict[str, float]]:
    """The table that one pipe writes, and the processor times of its steps [s]."""
    (folder / "times").unlink(missing_ok=True)
    parts = (
        TIMED.format(name=name, command=command.format(seed=seed))
        for name, command in STEPS.items()
    )
    table = shell(folder, " | ".join(f"( {part} )" for part in parts))
    rows = (line.split() for line in (folder / "times").read_text().splitlines())
    return table, {name: float(time) for name, time in rows}


def identified(name: str, seeds: int) -> tuple[Array, dict[str, float]]:
    """Errors in units of stated errors, of all estimates that have one; times of the last pipe."""
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        arm = load(str(described(URDFS / f"{name}.urdf", folder)))
        found = []
        for seed in range(seeds):
            table, times = pipe(folder, seed)
            estimates, errors = (
                column(table, what, arm.names) for what in ("estimate", "robust_error")
            )
            found.append((estimates - arm.apriori) / errors)
    return np.array(found), times


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=5)
    seeds = parser.parse_args().seeds
    print(f"| arm | parameters | {' | '.join(f'{name} [s]' for name in STEPS)} | rms | beyond 3 |")
    print("|---" * (len(STEPS) + 4) + "|")
    for name in ARMS:
        found, times = identified(name, seeds)
        known = found[np.isfinite(found)]
        seconds = " | ".join(f"{times[step]:.1f}" for step in STEPS)
        beyond = f"{np.count_nonzero(np.abs(known) > 3.0)} of {len(known)}"
        size = np.sqrt(np.mean(known**2))
        print(f"| {name} | {found.shape[1]} | {seconds} | {size:.2f} | {beyond} |", flush=True)


if __name__ == "__main__":
    main()
