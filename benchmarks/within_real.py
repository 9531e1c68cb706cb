"""Is the torque of another part of a real record within what `identify` states?

    python benchmarks/within_real.py

Each part of the records of parts.py is identified with nothing set, and predicts the others. The
error of the prediction [%] holds the noise of the other part as well: it is compared with the
stated interval and the residual of the identification, added as squares. The last line has the part
of the joints that are within the interval of the needed torque so, and within that of the model's.
"""

from __future__ import annotations

import json
import os
import subprocess
import tempfile
from itertools import permutations
from math import hypot
from pathlib import Path

import numpy as np
from parts import DATA, PENDULUM, TX40

EMPS = f"{DATA}/emps/emps_train.csv"
ARM = f"{DATA}/staubli_tx40/tx40_joint_5kHz.parquet"
RECORDS = {
    "emps": [
        f"convert --robot emps --from-time {a} --to-time {a + 5} {EMPS}" for a in range(0, 25, 5)
    ],
    "tx40.toml": [
        f"convert --robot tx40.toml {part} {ARM}" for part in ("--to-time 4.4", "--from-time 4.4")
    ],
    "planar2-gravity": [
        f"resample --rate 500 {DATA}/double_pendulum/20230629-{run}.csv" for run in PENDULUM
    ],
}


def scarid(words: str) -> str:
    """What the command prints."""
    command = ["scarid", *words.split(), "--quiet"]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def main() -> None:
    within = []
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        Path("tx40.toml").write_text(TX40)
        print("| robot | log | other | joint | error | needed | model | residual |")
        print("|---|---|---|---|---|---|---|---|")
        for robot, commands in RECORDS.items():
            for k, words in enumerate(commands):
                scarid(f"{words} -o {k}.parquet")
                scarid(f"identify --robot {robot} {k}.parquet -o parameters{k}.parquet")
            for k, other in permutations(range(len(commands)), 2):
                own = json.loads(scarid(f"identify --json --robot {robot} {k}.parquet"))
                words = f"validate --json --parameters parameters{k}.parquet {other}.parquet"
                pairs = zip(own["joints"], json.loads(scarid(words))["joints"], strict=True)
                for joint, predicted in pairs:
                    error, residual = predicted["relative_error"], joint["relative_error"]
                    names = ("needed_half_interval", "torque_half_interval")
                    if None in (joint[name] for name in names):
                        continue  # a joint of which nothing is known
                    stated = [100.0 * joint[name] for name in names]
                    row = [error, *stated, residual]
                    numbers = " | ".join(f"{x:.1f}" for x in row)
                    print(f"| {robot} | {k} | {other} | {joint['joint']} | {numbers} |")
                    within.append([error <= hypot(x, residual) for x in stated])
    needed, model = 100.0 * np.mean(within, axis=0)
    print(f"\n{len(within)} joints: {needed:.0f} % within the needed torque, {model:.0f} % without")


if __name__ == "__main__":
    main()
