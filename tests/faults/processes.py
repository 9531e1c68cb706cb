"""Faults between processes: signals, full disks, closed descriptors, writers at the same time."""

from __future__ import annotations

import os
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from faults.material import files
from faults.trials import (
    CRASHED,
    EXIT_1,
    KILLED,
    LEFT,
    LINES,
    OTHER,
    REFUSAL,
    REFUSED,
    RIGHT,
    UNNOTICED,
    Trial,
    folder_of,
    removed,
)

SCARID = str(Path(sys.executable).parent / "scarid")
STAGES = (("trajgen", "-q", "--duration", "4"), ("simulate", "-q"), ("differentiate", "-q"))
SIGNALS = (signal.SIGTERM, signal.SIGKILL, signal.SIGINT, signal.SIGHUP, signal.SIGPIPE)


def limits(count: int) -> Iterator[Trial]:
    """Outputs that may not be longer than some bytes, and those of a full device."""
    folder, rng = folder_of(files()), np.random.default_rng(4)
    for k in range(count):
        ending = ("csv", "parquet", "arrows", "arrow")[k % 4]
        most = int(rng.integers(20_000))
        full = rng.random() < 0.2
        target = (
            "/dev/full",
            "--format",
            {"arrows": "arrow", "arrow": "arrow-file"}.get(ending, ending),
        )
        words = ("convert", "log.csv", "-o", *(target if full else (f"out.{ending}",)))

        def before(most: int = most) -> None:
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))

        yield Trial(
            f"at most {most} bytes", words, folder, lambda _, full=full: not full, before=before
        )  # type: ignore[misc]
    removed(folder)


def descriptors() -> Iterator[Trial]:
    """Commands that find standard streams closed."""
    folder = folder_of(files())
    for closed in ((0,), (1,), (2,), (0, 1), (1, 2), (0, 2), (0, 1, 2)):
        for words in (("filter", "log.csv"), ("filter",), ("info", "log.parquet"), ("filter", "nothing.csv"),
                      ("convert", "log.csv", "-o", "out.parquet"), ("convert", "log.csv", "-o", "/dev/stdout")):  # fmt: skip
            yield Trial(f"closed {closed}", (*words, f"#{closed}"), folder)
    removed(folder)


def closed(trial: Trial) -> str:
    """The outcome of a command of `descriptors`, in a real process; the last word is not its own."""
    *words, note = trial.words
    numbers = [int(x) for x in note if x.isdigit()]
    redirected = " ".join(f"{'<' if n == 0 else f'{n}>'}&-" for n in numbers)
    done = subprocess.run(["bash", "-c", f'exec "$@" {redirected}', "-", SCARID, *words], cwd=trial.folder,
                          stdin=subprocess.DEVNULL, capture_output=True, check=False)  # fmt: skip
    if done.returncode in REFUSED:
        return REFUSAL if done.stderr.count(b"\n") == (2 not in numbers) else LINES
    if done.returncode == 0:
        written = 1 in numbers and words[0] != "convert"
        return OTHER if written or (words[-1] == "/dev/stdout" and 1 in numbers) else RIGHT
    return EXIT_1 if done.returncode > 0 else CRASHED


def interrupted(count: int) -> Iterator[tuple[str, str]]:
    """Pipes of which a stage gets a signal at a random moment: the fault and its outcome."""
    rng = np.random.default_rng(5)
    folder = folder_of({})
    rights: dict[str, bytes] = {}
    for k in range(count):
        form = ("csv", "arrow", "parquet")[k % 3]
        if form not in rights:
            assert not any(_piped(form, folder, None)[0])
            rights[form] = (folder / "out.parquet").read_bytes()
        stage, number = int(rng.integers(3)), SIGNALS[int(rng.integers(len(SIGNALS)))]
        moment = float(rng.uniform(0.0, 1.5))
        (folder / "out.parquet").unlink(missing_ok=True)
        statuses, errors = _piped(form, folder, (stage, number, moment))
        result = _of_processes(folder, statuses, errors, (stage, number))
        yield (
            f"{form}, {number.name} to {STAGES[stage][0]} after {moment:.2f} s",
            result or _of_output(folder, rights[form], statuses, (form, stage, number)),
        )
        for part in folder.glob(".*.part"):
            part.unlink()
    removed(folder)


def _piped(
    form: str, folder: Path, hit: tuple[int, signal.Signals, float] | None
) -> tuple[list[int], list[bytes]]:
    """The status of each stage, and what it said."""
    processes: list[subprocess.Popen[bytes]] = []
    for i, words in enumerate(STAGES):
        last = i == len(STAGES) - 1
        place = ("-o", "out.parquet", "--no-history") if last else ("--format", form)
        source = processes[-1].stdout if processes else subprocess.DEVNULL
        processes.append(subprocess.Popen([SCARID, *words, *place], cwd=folder, stdin=source,
                                          stdout=subprocess.PIPE, stderr=subprocess.PIPE))  # fmt: skip
        if i:
            before = processes[-2].stdout
            assert before
            before.close()
    if hit:
        time.sleep(hit[2])
        if processes[hit[0]].poll() is None:
            processes[hit[0]].send_signal(hit[1])
    errors = [process.stderr.read() for process in processes if process.stderr]
    return [process.wait() for process in processes], errors


def _of_processes(
    folder: Path, statuses: list[int], errors: list[bytes], hit: tuple[int, signal.Signals]
) -> str:
    """What must not be of how the stages ended; nothing if all is well.

    Only the stage that was hit may end by the signal, and others because of it. What the
    interpreter says if it is interrupted before it has reached a line of ours is not judged.
    """
    expected = {0, *REFUSED, -signal.SIGPIPE}
    if b"KeyboardInterrupt" in errors[hit[0]] and b"/scarid_cli/" not in errors[hit[0]]:
        return ""
    for i, status in enumerate(statuses):
        if status not in expected | ({-hit[1]} if i == hit[0] else set()):
            return CRASHED if status < 0 else EXIT_1
    if any(error.count(b"\n") > 1 for error in errors):
        return LINES
    by_hand = hit[1] in (signal.SIGKILL, signal.SIGHUP) and hit[0] == len(STAGES) - 1
    return LEFT if list(folder.glob(".*.part")) and not by_hand else ""


def _of_output(
    folder: Path, right: bytes, statuses: list[int], hit: tuple[str, int, signal.Signals]
) -> str:
    """The outcome that the output shows; without one, a stage must have failed at the end."""
    out, (form, stage, number) = folder / "out.parquet", hit
    if not out.exists():
        return KILLED if statuses[-1] else OTHER
    if out.read_bytes() == right:
        return RIGHT
    # The end of CSV is not marked: a stage that could not say that it was killed leaves a short one.
    silent = form == "csv" and number in (signal.SIGKILL, signal.SIGHUP)
    return UNNOTICED if silent and stage < len(STAGES) - 1 else OTHER


def together(count: int) -> Iterator[tuple[str, str]]:
    """Several runs that write one output at the same time: it is that of one of them."""
    for k in range(count):
        folder = folder_of(files())
        runs = [
            ["trajgen", "-q", "--no-history", "--seed", str(seed), "--duration", "3"]
            for seed in range(4)
        ]
        rights = []
        for words in runs:
            done = subprocess.run(
                [SCARID, *words, "--format", "parquet"], capture_output=True, check=True
            )
            rights.append(done.stdout)
        started = [
            subprocess.Popen([SCARID, *words, "-o", "out.parquet"], cwd=folder) for words in runs
        ]
        statuses = [process.wait() for process in started]
        whole = (folder / "out.parquet").read_bytes() in rights and not list(folder.glob(".*.part"))
        yield f"round {k}", (RIGHT if whole else OTHER) if not any(statuses) else EXIT_1
        removed(folder)


def everything_imported() -> None:
    """Import what commands import when they run, so that forks need not."""
    import scarid_cli.cli.running.job
    import scarid_cli.io.pages  # noqa: F401

    os.environ["NO_COLOR"] = "1"
