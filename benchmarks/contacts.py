"""False alarms and contacts of `scarid validate --residual`: `python benchmarks/contacts.py`.

Simulated robots, some with imperfections that no model has. Each is identified from one log of
20 s, and judged on another one of two minutes, with the band of so many false alarms in an hour.
Then something pushes for 0.3 s, once in 4 s, at a joint after the other, with a part of the band:
of 1, 1.5 and 2 times its least width, the share that is found, and the median time until then.
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from arms import URDFS, described

import scarid

RATE = 60.0  # false alarms in an hour of motion
SECONDS = 120.0
EVERY, LASTS, FIRST = 4.0, 0.3, 3.0  # s
SIZES = (1.0, 1.5, 2.0)
LIMITS = {"planar2-gravity": {"q_max": "2,2", "ddq_max": "10,10"}}
CONDITIONS: dict[str, tuple[str, ...]] = {
    "clean": (),
    "load-dependent friction": ("load-friction=0.05",),
    "friction drifts": ("friction-drift=0.3",),
    "flexible joints": ("flexibility=25",),
}


def log(robot: str, seed: int, seconds: float, *imperfections: str) -> scarid.Log:
    limits = LIMITS.get(robot, {})
    reference = scarid.trajgen(seed=seed, robot=robot, duration=seconds, **limits)
    return scarid.simulate(reference, seed=seed, robot=robot, with_=imperfections)


def residual(
    motion: scarid.Log | pa.Table, known: object, robot: str, *observer: float
) -> pa.Table:
    """The table of `validate --residual`."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "residual.parquet"
        given = {"observer": observer[0]} if observer else {}
        scarid.validate(
            motion, parameters=known, robot=robot, residual=path, false_alarms=RATE, **given
        )
        return pq.read_table(path)


def pushed(motion: scarid.Log, table: pa.Table, size: float) -> pa.Table:
    """The log with torques that something else pushes with."""
    found = motion.to_arrow()
    t = found.column("t").to_numpy()
    joints = sum(name.endswith("_band") for name in table.column_names)
    number = ((t - FIRST) // EVERY).astype(int)
    inside = (t >= FIRST) & ((t - FIRST) % EVERY < LASTS)
    for j in range(1, joints + 1):
        least = float(np.nanmin(table.column(f"tau{j}_band").to_numpy()))
        push = size * least * (inside & (number % joints == j - 1))
        name = f"tau{j}"
        found = found.set_column(
            found.column_names.index(name), found.schema.field(name),
            pa.array(found.column(name).to_numpy() + push),
        )  # fmt: skip
    return found


def alarms(table: pa.Table) -> int:
    """How many contacts are called that are 0.1 s apart."""
    t = table.column("t").to_numpy()[table.column("contact").to_numpy() > 0]
    return int(len(t) > 0) + int(np.count_nonzero(np.diff(t) > 0.1))


def found(table: pa.Table) -> tuple[float, list[float]]:
    """The share of the pushes that are found, and after which time [s] each of them is."""
    t, contact = table.column("t").to_numpy(), table.column("contact").to_numpy()
    starts = np.arange(FIRST, t[-1] - LASTS, EVERY)
    starts = starts[starts > t[0]]
    after = [t[(contact > 0) & (t >= start) & (t < start + LASTS)] - start for start in starts]
    return float(np.mean([len(x) > 0 for x in after])), [float(x[0]) for x in after if len(x)]


def row(name: str, robot: str, condition: str, seeds: range, *observer: float) -> str:
    count, shares, times = 0, {size: [] for size in SIZES}, []
    for seed in seeds:
        known = scarid.identify(log(robot, 1000 + seed, 20.0, *CONDITIONS[condition]), robot=robot)
        motion = log(robot, 2000 + seed, SECONDS, *CONDITIONS[condition])
        plain = residual(motion, known, robot, *observer)
        count += alarms(plain)
        for size in SIZES:
            share, when = found(residual(pushed(motion, plain, size), known, robot, *observer))
            shares[size].append(share)
            times += when if size == SIZES[-1] else []
    hours = len(seeds) * SECONDS / 3600.0
    told = " | ".join(f"{np.mean(share):.0%}" for share in shares.values())
    late = f"{1e3 * np.median(times):.0f} ms" if times else "-"
    how = f"observer {observer[0]:g} Hz" if observer else "torques"
    return f"| {name} | {condition} | {how} | {count / hours:.0f} | {told} | {late} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--robots", default="scara2,planar2-gravity,ur10")
    parser.add_argument("--conditions", default=",".join(CONDITIONS))
    given = parser.parse_args()
    heads = " | ".join(f"{size:g} times" for size in SIZES)
    print(f"| robot | condition | residual | alarms in an hour, {RATE:g} asked | {heads} | after |")
    print("|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for name in given.robots.split(","):
            urdf = URDFS / f"{name}.urdf"
            robot = str(described(urdf, Path(folder))) if urdf.exists() else name
            for condition in given.conditions.split(","):
                print(row(name, robot, condition, range(given.seeds)), flush=True)
            print(row(name, robot, "clean", range(given.seeds), 10.0), flush=True)


if __name__ == "__main__":
    main()
