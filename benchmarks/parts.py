"""Do the estimates of disjoint parts of real records differ as much as their errors say?

    python benchmarks/parts.py

Each part is identified by `scarid identify` with nothing set. The table has the scatter of each
parameter between the parts, about their weighted mean, over the stated errors: the root mean square
over the parameters, and the smallest and the largest of a parameter. It is 1 where the errors say
what occurs, and less where they allow for something that all parts share.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
from shells import column, shell

from scarid_cli.algorithms.robots.reading import load
from scarid_cli.arrays import Array

DATA = Path(__file__).parent.parent.parent / "shared/data"
JOINT = "[[joint]]\n"
TX40 = f"""title = "Staubli TX40"
urdf = "{DATA}/staubli_tx40/tx40_mdh_modified.urdf"
{6 * JOINT}terms = ["viscous", "coulomb", "offset"]
[[coupling]]
joints = [5, 6]
"""
PENDULUM = ("143524", "143601", "154220", "154548")  # in the others a joint is hardly driven
RECORDS = {
    "EMPS, five parts of 5 s": (
        "emps",
        [
            f"scarid identify -q --format csv --robot emps --from-time {a} --to-time {a + 5} "
            f"{DATA}/emps/emps_train.csv"
            for a in range(0, 25, 5)
        ],
    ),
    "TX40, two halves": (
        "tx40.toml",
        [
            f"scarid identify -q --format csv --robot tx40.toml {part} "
            f"{DATA}/staubli_tx40/tx40_joint_5kHz.parquet"
            for part in ("--to-time 4.4", "--from-time 4.4")
        ],
    ),
    "Double pendulum, four logs": (
        "planar2-gravity",
        [
            f"scarid resample -q --rate 500 {DATA}/double_pendulum/20230629-{run}.csv | "
            "scarid identify -q --format csv --robot planar2-gravity"
            for run in PENDULUM
        ],
    ),
}


def ratios(estimates: Array, errors: Array) -> Array:
    """The scatter of each parameter about the weighted mean of (parts, parameters), in errors."""
    weights = 1.0 / errors**2
    mean = np.sum(weights * estimates, axis=0) / np.sum(weights, axis=0)
    squares = np.sum(weights * (estimates - mean) ** 2, axis=0) / (len(estimates) - 1)
    return np.asarray(np.sqrt(squares))


def main() -> None:
    print("| record | rms | smallest | largest |")
    print("|---|---|---|---|")
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        (folder / "tx40.toml").write_text(TX40)
        for title, (robot, lines) in RECORDS.items():
            names = load(str(folder / robot) if robot.endswith(".toml") else robot).names
            tables = [shell(folder, line) for line in lines]
            estimates, errors = (
                np.array([column(table, what, names) for table in tables])
                for what in ("estimate", "robust_error")
            )
            found = ratios(estimates, errors)
            figures = (np.sqrt(np.mean(found**2)), found.min(), found.max())
            print(f"| {title} | {' | '.join(f'{x:.2f}' for x in figures)} |", flush=True)


if __name__ == "__main__":
    main()
