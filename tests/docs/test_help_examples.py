"""Every example in the help of every command runs, given files of the names that it uses."""

from __future__ import annotations

import contextlib
import os
import shlex
import shutil
import socket
import subprocess
from collections.abc import Iterator
from itertools import groupby
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from bags import STATE, state, write_mcap
from click.testing import CliRunner
from conftest import ROOT
from pyarrow import parquet
from scipy.io import savemat

from scarid_cli.__main__ import main
from scarid_cli.cli import COMMANDS, scarid
from scarid_cli.errors import WARNED

SLOW = ("--optimise", "--method all")  # run by `make docs-test`
NONE_LEFT = {
    "check": (WARNED, 65),  # which tells of the log, and not of the example
    "listen": (65,),  # nobody sends anything
}


def examples(*command: str) -> list[str]:
    """The examples in the help of a command, one to a line."""
    text = CliRunner().invoke(scarid, [*command, "--help"], env={"COLUMNS": "200"}).output
    lines = [line.strip() for line in text.splitlines()]
    found: list[str] = []
    for line in lines:
        if found and found[-1].endswith("|"):
            found[-1] += f" {line}"
        elif line.startswith("scarid ") and not line.startswith("scarid COMMAND"):
            found.append(line)
    return found


ALL = sorted({e for c in ([], *([c] for c in COMMANDS), ["robot", "check"]) for e in examples(*c)})


def run(line: str) -> Iterator[tuple[str, int]]:
    """Run a line as a shell would: each command of scarid, and its status."""
    lexer = shlex.shlex(line, punctuation_chars=True)  # not posix: '; ' in quotes stays in them
    lexer.whitespace_split = True
    words = list(lexer)
    for ends, part in groupby(words, lambda word: word in (";", "&&")):
        if not ends:
            yield from pipe(list(part))


def pipe(words: list[str]) -> Iterator[tuple[str, int]]:
    """Run the commands of a pipe one after the other, each with the output of the one before."""
    source = os.devnull
    steps = [list(step) for bar, step in groupby(words, lambda word: word == "|") if not bar]
    for number, step in enumerate(steps):
        target = f"piped{number}"
        if ">" in step:
            target = step[step.index(">") + 1]
            step = step[: step.index(">")]
        step = [word for quoted in step for word in shlex.split(quoted)]
        with Path(source).open("rb") as stdin, Path(target).open("wb") as stdout:
            if step[0] == "scarid":
                yield step[1], called(expanded(step[1:]), stdin.fileno(), stdout.fileno())
            else:
                subprocess.run(step, stdin=stdin, stdout=stdout, check=True)
        source = target


def expanded(words: list[str]) -> list[str]:
    """The words, with the files that a pattern such as *.parquet stands for."""
    found = []
    for word in words:
        files = sorted(map(str, Path().glob(word))) if "*" in word and "=" not in word else []
        found += files or [word]
    return found


def called(words: list[str], stdin: int, stdout: int) -> int:
    """The status of scarid in this process, with these descriptors as its input and output."""
    kept = os.dup(0), os.dup(1)
    os.dup2(stdin, 0)
    os.dup2(stdout, 1)
    try:
        with (
            os.fdopen(os.dup(1), "w", encoding="utf-8") as text,
            contextlib.redirect_stdout(text),
        ):
            return main(words)
    finally:
        for number, descriptor in enumerate(kept):
            os.dup2(descriptor, number)
            os.close(descriptor)


MADE = """
trajgen --seed 1 -o reference.parquet
trajgen --seed 1 -o reference.csv
convert log.csv -o log.parquet
differentiate log.csv -o motion.csv
differentiate log.csv -o motion.parquet
identify motion.parquet -o parameters.csv
identify --estimator wls motion.parquet -o p.parquet
validate --parameters p.parquet motion.parquet -o metrics.parquet
tune --method kalman log.csv --save log.toml -o trials.csv
trajgen --robot arm.toml --duration 8 -o arm.parquet
simulate --robot arm.toml arm.parquet -o arm-log.parquet
differentiate arm-log.parquet -o arm-motion.parquet
identify --robot arm.toml --estimator wls arm-motion.parquet -o arm-toml.parquet
identify --robot arm.urdf --estimator wls arm-motion.parquet -o arm-urdf.parquet
simulate --robot arm.toml --with payload=2,0,0,0.1,0,0,0,0,0,0,0 arm.parquet -o loaded.parquet
convert loaded.parquet -o loaded.csv
identify --robot arm.toml arm-log.parquet -o bare.parquet
"""
# The other names that the examples use for these files.
NAMES = {
    "log.csv": ["monday.csv", "tuesday.csv", "july.csv"],
    "log.parquet": ["monday.parquet", "tuesday.parquet"],
    "p.parquet": [
        "before.parquet",
        "after.parquet",
        "near.parameters.parquet",
        "january.parquet",
        "february.parquet",
        "march.parquet",
        "may.parquet",
        "june.parquet",
    ],
    "metrics.parquet": ["runs/1/p2smd.cross.metrics.parquet", "runs/2/p2smd.cross.metrics.parquet"],
}
OF_THE_ARM = {"arm-motion.parquet": ["motion.parquet"], "arm-toml.parquet": ["p.parquet"]}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with files of every name that an example uses."""
    place = tmp_path_factory.mktemp("examples")
    for source, *names in (("arm.toml", "arm.toml", "mine.toml"), ("arm.urdf", "arm.urdf"),
                           ("scara2.csv", "log.csv")):  # fmt: skip
        for name in names:
            shutil.copy(ROOT / "samples" / source, place / name)
    with contextlib.chdir(place), Path(os.devnull).open("r+b") as null:
        for line in MADE.split("\n"):
            assert not line or called([*line.split(), "-q"], null.fileno(), null.fileno()) == 0, (
                line
            )
        for name, others in NAMES.items():
            copied(name, others)
        of_others()
        of_a_batch(Path("outcome"))
    return place


def of_a_batch(outcome: Path) -> None:
    """The tables of a batch with a single log."""
    outcome.mkdir()
    log = {"robot": ["scara2"], "log": ["monday"], "order": [1]}
    estimate = {"parameter": ["ZZ2"], "unit": ["kg m2"], "estimate": [0.064]}
    tables = {
        "fleet": {**log, "file": ["monday.csv"], "status": [0]},
        "estimates": {**log, **estimate, "robust_error": [0.001], "low": [0.062], "high": [0.066]},
        "robots": {
            "robot": ["scara2"],
            "description": ["scara2"],
            "logs": [1],
            "identified": [1],
            "failed": [0],
        },
    }
    for kind, columns in tables.items():
        parquet.write_table(pa.table(columns), outcome / f"{kind}.parquet")


def copied(name: str, others: list[str]) -> None:
    for other in others:
        Path(other).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(name, other)


def of_others() -> None:
    """Files that other programs have written."""
    t = np.arange(600) / 500.0
    q, tau = np.sin([5.0 * t, 7.0 * t]), np.cos([5.0 * t, 7.0 * t])
    rows = np.vstack((q, tau)).T

    def written(name: str, columns: np.ndarray, names: str, **how: str) -> None:
        np.savetxt(name, columns, delimiter=",", header=names, comments="", **how)

    written("points.csv", np.array([[0, 0, 0], [1, 0.5, -0.5], [2, 0, 0]]), "t,q1,q2")
    written("robot.csv", np.column_stack((t, q[0], tau[0])), "t,encoder_a,load_a")
    written("motors.csv", rows, "enc_a,enc_b,i_a,i_b")
    written("positions.txt", q.T, "positions1,positions2")
    written("torques.txt", tau.T, "torques1,torques2")
    text = "\n".join(";".join(f"{x:.6f}" for x in row) for row in zip(t, q[0], tau[0], strict=True))
    Path("export.txt").write_text(text.replace(".", ","), "utf-8")
    savemat("measured.mat", {"q": q.T, "tau": tau.T})
    names = ["shoulder", "elbow"]
    messages = (
        (
            "/joint_states",
            k * 2 * 10**6,
            state(k * 2 * 10**6, names, position=q[:, k], effort=tau[:, k]),
        )
        for k in range(len(t))
    )
    write_mcap(Path("recording.mcap"), {"/joint_states": STATE}, messages)


def free_port() -> int:
    """A port of this machine that no program listens at: examples run beside each other."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return int(free.getsockname()[1])


@pytest.mark.parametrize("line", ALL)
def test_an_example_in_the_help_runs(
    line: str, folder: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    if any(words in line for words in SLOW) and os.environ.get("SCARID_DOCS") != "all":
        pytest.skip("slow: make docs-test")
    place = tmp_path / "here"
    shutil.copytree(folder, place)
    with contextlib.chdir(place):
        if "urdf --parameters" in line or ("export" in line and "arm.toml" in line):
            for name, others in OF_THE_ARM.items():
                copied(name, others)
        arm = "arm-urdf.parquet" if "arm.urdf" in line else "arm-toml.parquet"
        shutil.copy(arm, "parameters.parquet")
        for command, status in run(line.replace("--port 5000", f"--port {free_port()}")):
            assert status in (0, *NONE_LEFT.get(command, ())), capfd.readouterr().err


def test_there_are_many_examples() -> None:
    """So that a change of the help cannot quietly turn this module off."""
    assert len(ALL) > 50
