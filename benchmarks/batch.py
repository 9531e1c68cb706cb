"""Shell pipes, `then`, and batches: `make bench-batch LOGS=1000`, or some `PARTS="growth killed"`.

The machine may be shared, so processor seconds stand beside wall-clock seconds, and everything that
is compared runs in turns; the least of some rounds counts. Fleets are simulated once and kept in
build/. A thousand logs take twenty minutes on two cores that do nothing else.
"""

from __future__ import annotations

import json
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from datetime import timedelta
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
from fleet import DRIFTING, START, fleet

ROOT = Path(__file__).parent.parent
BIN = Path(sys.executable).parent
BATCH = Path(os.environ.get("BATCH_PYTHON", ROOT / ".venv-batch" / "bin" / "python"))
BUILD = ROOT / "build"
ROUNDS = 5
OF_BATCHES = 2  # rounds
SIX_JOINTS = 16  # logs
SIX = ROOT / "samples" / "robots" / "ur10e.toml"
PIPES = {
    "filter, differentiate, identify": ("filter --cutoff 20 LOG", "differentiate", "identify -q"),
    "convert, resample, filter, differentiate, identify": (
        "convert LOG", "resample -q --rate 200", "filter --cutoff 20", "differentiate",
        "identify -q",
    ),
}  # fmt: skip
Spent = tuple[float, float]  # wall-clock and processor seconds


def spent(run: Callable[[], object]) -> Spent:
    """What a run takes, its child processes included."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    run()
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return time.perf_counter() - start, cpu


def environment(**more: str) -> dict[str, str]:
    """The environment with these variables; modules are compiled once, on one core each."""
    found = {**os.environ, **more, "PYTHONPYCACHEPREFIX": str(BUILD / "pycache")}
    found.pop("PYTHONDONTWRITEBYTECODE", None)
    return {**found, "OMP_NUM_THREADS": "1"}


def shell(line: str, folder: Path) -> None:
    """Run a line of a shell; what it prints is dropped."""
    path = f"{BIN}{os.pathsep}{os.environ['PATH']}"
    subprocess.run(
        ["bash", "-o", "pipefail", "-c", line],
        cwd=folder, env=environment(PATH=path, SCARID_FORMAT="arrow"), check=True,
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip


def logs(folder: Path) -> Iterator[tuple[str, Path, str]]:
    """A log of two joints and one of six: a title, the file, and the robot's option."""
    folder.mkdir(parents=True, exist_ok=True)
    for title, robot, rate in (
        ("4,000 rows, 2 joints", "scara2", 200),
        ("20,000 rows, 6 joints", SIX, 1000),
    ):
        log = folder / f"{Path(robot).stem}.csv"
        if not log.exists():
            move = f"trajgen -q --robot {robot} --duration 20 --seed 1"
            rates = f"--log-rate {rate} --control-rate 1000"
            shell(f"scarid {move} then simulate -q --robot {robot} {rates} -o {log}", folder)
        yield title, log, f" --robot {robot}"


def pipes(folder: Path) -> None:
    """The same stages as a pipe and in one process, in turns; the least of some rounds."""
    print(f"A pipe and `then`: wall-clock and processor seconds, least of {ROUNDS} rounds in turns")
    print("(at once: the ratio of the wall-clock times of one such line on each core)")
    print("  log                   stages       pipe         then       ratios  at once")
    for title, log, robot in logs(folder):
        for stages in PIPES.values():
            named = [stage.replace("LOG", str(log)) for stage in stages]
            named[-1] += robot
            lines = (" | ".join(f"scarid {s}" for s in named), f"scarid {' then '.join(named)}")
            (wall, cpu), (own_wall, own_cpu) = least(lines, folder)
            (busy, _), (own_busy, _) = least(tuple(map(on_each_core, lines)), folder)
            print(
                f"  {title:21}{len(stages):5} {wall:6.2f} {cpu:5.2f} {own_wall:6.2f} {own_cpu:5.2f}"
                f"  {wall / own_wall:4.1f} {cpu / own_cpu:4.1f}  {busy / own_busy:7.1f}",
                flush=True,
            )


def on_each_core(line: str) -> str:
    """A line of a shell that runs once on each core at the same time."""
    return f"{' & '.join([f'({line})'] * (os.cpu_count() or 1))} & wait"


def least(lines: tuple[str, ...], folder: Path) -> list[Spent]:
    """The least that each line of a shell takes, all in turns."""
    runs = [[spent(lambda line=line: shell(line, folder)) for line in lines] for _ in range(ROUNDS)]
    of_each = zip(*runs, strict=True)
    return [(min(wall for wall, _ in own), min(cpu for _, cpu in own)) for own in of_each]


def in_one_process(config: Path) -> None:
    """All steps of a batch, one after the other."""
    words = [BATCH, "-m", "steps", "all", config.name]
    path = environment(PYTHONPATH=str(ROOT / "workflow"))
    subprocess.run(words, cwd=config.parent, env=path, check=True)


def batch(config: Path) -> subprocess.Popen[bytes]:
    """A batch by Snakemake on all cores, without the page of the fleet."""
    words = [BATCH, ROOT / "workflow" / "batch.py", config, "outcome/fleet.parquet"]
    quiet = subprocess.DEVNULL
    return subprocess.Popen(
        words, stdout=quiet, stderr=quiet, start_new_session=True, env=environment()
    )


def finished(process: subprocess.Popen[bytes]) -> None:
    if process.wait():
        raise RuntimeError("the batch failed; see .snakemake/log")


def by_commands(config: Path, count: int, joined: str) -> None:
    """The work of a batch on some logs, as a loop of a shell does it."""
    robot, out = "--robot robot1.toml", config.parent / "loop"
    out.mkdir(exist_ok=True)
    for log in sorted((config.parent / "logs" / "robot1").glob("*.csv"))[:count]:
        at = f"{out}/{log.stem}"
        lines = (
            (f"convert {robot} {log}", f"tee {at}.arrows", f"check --json {robot}"),
            (
                f"differentiate {at}.arrows --settings outcome/robots/robot1/settings.toml",
                f"tee {at}.motion.arrows",
                f"identify {robot} --estimator gls --align -o {at}.parquet",
            ),
            (f"validate {at}.motion.arrows --parameters {at}.parquet {robot}",),
        )
        for line in lines:
            shell(f"scarid {joined.join(line)} || true", config.parent)
    shutil.rmtree(out)


def growth(counts: list[int]) -> None:
    """What a log costs in batches of different sizes, in one process and by Snakemake."""
    print("\nBatches of four robots, logs of 4,000 rows, 250 a job")
    for count in counts:
        batches(fleet(BUILD / f"fleet{count}", count, group=250, pages="none"), count)


def batches(config: Path, count: int) -> None:
    """A batch in one process and by Snakemake, in turns: seconds a log, wall and processor."""
    one, snakemake = [], []
    for _ in range(OF_BATCHES):
        fresh(config)
        one.append(spent(lambda: in_one_process(config)))
        fresh(config)
        snakemake.append(spent(lambda: finished(batch(config))))
    (wall, cpu), (own_wall, own_cpu) = (tuple(map(min, zip(*x, strict=True)))
                                        for x in (one, snakemake))  # fmt: skip
    cores = os.cpu_count() or 1
    print(
        f"  {count:5} logs: one process {wall / count:.3f} {cpu / count:.3f},"
        f" Snakemake {own_wall / count:.3f} {own_cpu / count:.3f};"
        f" {count / own_wall / cores:.2f} logs a second and core,"
        f" {wall / own_wall / cores:.2f} of all cores' throughput"
        f" ({cpu / own_cpu:.2f} by processor time)",
        flush=True,
    )


def six_joints(count: int) -> None:
    """The same for logs of 20,000 rows of six joints, in jobs of a quarter."""
    folder = BUILD / "six"
    (folder / "logs").mkdir(parents=True, exist_ok=True)
    for seed in range(count):
        log = folder / "logs" / f"{START + timedelta(days=seed)}.csv"
        if not log.exists():
            move = f"trajgen -q --robot {SIX} --duration 20 --seed {seed}"
            rates = f"--log-rate 1000 --control-rate 1000 --seed {seed}"
            part = log.with_suffix(".part.csv")
            shell(f"scarid {move} then simulate -q --robot {SIX} {rates} -o {part}", folder)
            part.replace(log)
    config = folder / "fleet.toml"
    config.write_text(
        f'group = {-(-count // 4)}\npages = "none"\n[robots.ur10e]\nrobot = "{SIX}"\n'
        'logs = "logs/*.csv"\n'
    )
    print("\nBatches of one robot, logs of 20,000 rows and six joints, a quarter of them a job")
    batches(config, count)


def fresh(config: Path) -> None:
    for name in ("outcome", ".snakemake"):
        shutil.rmtree(config.parent / name, ignore_errors=True)


def ways(config: Path, count: int) -> None:
    """The same work on some logs: by pipes, and by `then`."""
    print(f"\nconvert, check, differentiate, identify, validate: {count} logs, one after the other")
    for name, joined in (("three pipes a log", " | scarid "), ("three chains a log", " then ")):
        wall, cpu = spent(lambda joined=joined: by_commands(config, count, joined))
        print(
            f"  {name:20} {count / wall:5.2f} logs a second, {count / cpu:5.2f} a second of a core"
        )


def found(config: Path) -> None:
    """What the tables say of the logs about which something is known."""
    truth = json.loads((config.parent / "truth.json").read_text())
    rows = pq.read_table(config.parent / "outcome" / "fleet.parquet").to_pylist()
    counts: dict[str, Counter[str]] = {}
    for row in rows:
        log = truth[f"{row['robot']}/{row['log']}.csv"]
        counts.setdefault(done_to(log), Counter())[verdict(row)] += 1
    print("\nWhat was done to a log, and what its row says")
    for kind in sorted(counts):
        listed = ", ".join(f"{count} {said}" for said, count in counts[kind].most_common())
        print(f"  {kind:18} {sum(counts[kind].values()):5}: {listed}")
    for robot in pq.read_table(config.parent / "outcome" / "robots.parquet").to_pylist():
        print(f"  {robot['robot']}: {robot['trend']}")


def done_to(log: dict[str, Any]) -> str:
    """What was done to a log, in a few words."""
    if log["spoil"]:
        return f"spoiled: {log['spoil']}"
    if log["payload"]:
        return "another payload"
    return "drifting friction" if log["robot"] == DRIFTING else "as it was"


def verdict(row: dict[str, Any]) -> str:
    """The row in a few words."""
    if row["status"]:
        return f"error of {row['step']}"
    if row["check"] == "failed":
        return "check failed"
    if row["change"] == "changed":
        return row["change_reason"].split(" (")[0].split(" of ")[0].split(":")[0]
    return str(row["change"])


def killed(config: Path, seed: int) -> None:
    """Kill a batch at a random moment, restart it, and compare with an uninterrupted one."""
    fresh(config)
    wall, _ = spent(lambda: finished(batch(config)))
    before = outcome(config)
    fresh(config)
    process = batch(config)
    seconds = random.Random(seed).uniform(0.1, 0.9) * wall
    time.sleep(seconds)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    done = len([*(config.parent / "outcome" / "logs").glob("*/*/parameters.parquet")])
    again, _ = spent(lambda: finished(batch(config)))
    same = "the same bytes" if outcome(config) == before else "OTHER BYTES"
    print(
        f"\nUninterrupted {wall:.0f} s; killed after {seconds:.0f} s with {done} logs identified,"
        f" restarted and ended after another {again:.0f} s: {same} in {len(before)} files"
    )


def outcome(config: Path) -> dict[str, bytes]:
    out = config.parent / "outcome"
    paths = (path for path in out.rglob("*") if path.is_file() and "jobs" not in path.parts)
    return {str(path): path.read_bytes() for path in paths if path.name != ".lock"}


def ended(config: Path) -> Path:
    """The configuration, after its batch."""
    if not (config.parent / "outcome" / "fleet.parquet").exists():
        finished(batch(config))
    return config


PARTS = ("pipes", "six", "growth", "found", "ways", "killed")


def main(most: int, parts: tuple[str, ...]) -> None:
    """The parts of the benchmark, with fleets of at most so many logs."""
    counts = [count for count in (10, 100, 1000, 10_000) if count <= most]
    counts = counts if most in counts else [*counts, most]
    config = fleet(BUILD / f"fleet{most}", most, group=250, pages="none")
    run: dict[str, Callable[[], None]] = {
        "pipes": lambda: pipes(BUILD / "pipes"),
        "six": lambda: six_joints(min(SIX_JOINTS, most)),
        "growth": lambda: growth(counts),
        "found": lambda: found(ended(config)),
        "ways": lambda: ways(ended(config), min(20, most // 4)),
        "killed": lambda: killed(config, most),
    }
    for part in parts:
        run[part]()


if __name__ == "__main__":
    number, *chosen = sys.argv[1:] or ["1000"]
    main(int(number), tuple(chosen) or PARTS)
