"""Outputs are not mixed, not lost, and left as they were unless the command succeeds."""

from __future__ import annotations

import errno
import io
import os
import stat
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from conftest import Result

from scarid_cli.io.outgoing import FileWriter, ParquetWriter, StreamWriter

Run = Callable[..., Result]

SPELLINGS = {
    "another spelling": ("a.csv", "./a.csv"),
    "a folder and back": ("a.csv", "folder/../a.csv"),
    "a symbolic link": ("a.csv", "link.csv"),
    "standard output": ("-", "/dev/stdout"),
    "standard output as a file": ("/dev/stdout", "/dev/fd/1"),
}


@pytest.mark.parametrize("name", SPELLINGS)
def test_two_outputs_under_two_spellings_of_one_path_are_refused(
    name: str, shell: Run, tmp_path: Path
) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "link.csv").symlink_to("a.csv")
    first, second = SPELLINGS[name]
    result = shell(f"scarid trajgen --duration 3 -o {first} --expected {second} --torque-noise 1")
    assert result.status == 2
    assert result.out == ""
    assert "two outputs cannot share it" in result.err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["folder", "link.csv"]


@pytest.mark.parametrize(
    "line",
    [
        "identify log.csv -o log.csv",
        "identify log.csv -o other.csv --trace ./log.csv",
        "filter log.csv -o link.csv",
        "filter log.csv then differentiate -o log.csv",
    ],
)
def test_a_log_is_not_replaced_by_what_is_made_of_it(
    line: str, shell: Run, tmp_path: Path, samples: Path
) -> None:
    log = tmp_path / "log.csv"
    log.write_bytes((samples / "scara2.csv").read_bytes())
    (tmp_path / "link.csv").symlink_to("log.csv")
    result = shell(f"scarid {line}")
    assert (result.status, result.out) == (2, "")
    assert "this is the input; give the output another FILE" in result.err
    assert log.read_bytes() == (samples / "scara2.csv").read_bytes()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["link.csv", "log.csv"]


def test_an_output_that_replaces_a_file_keeps_its_mode_and_follows_a_link(
    shell: Run, tmp_path: Path
) -> None:
    (tmp_path / "folder").mkdir()
    file, link = tmp_path / "folder" / "a.csv", tmp_path / "link.csv"
    file.write_text("before")
    file.chmod(0o640)
    link.symlink_to("folder/a.csv")
    assert shell("scarid -h > /dev/null; scarid trajgen --duration 3 -q -o link.csv").status == 0
    assert link.is_symlink()
    assert file.read_text().startswith("t,q1_ref")
    assert stat.S_IMODE(file.stat().st_mode) == 0o640


def test_the_rest_of_a_killed_run_is_told_and_removed(shell: Run, tmp_path: Path) -> None:
    """That of a run which is still there is left alone, and so is any other file.

    A run that is refused says nothing but why.
    """
    mine = tmp_path / f".a.csv.{os.getpid()}.0123456789ab.part"
    others = [
        mine,
        tmp_path / ".a.csv.x.0123456789ab.part",
        tmp_path / ".b.csv.999999999.0123456789ab.part",
    ]
    abandoned = tmp_path / ".a.csv.999999999.0123456789ab.part"
    young = tmp_path / ".a.csv.999999998.0123456789ab.part"
    for path in (abandoned, *others):
        path.write_text("a part")
        os.utime(path, (0.0, 0.0))
    young.write_text("perhaps of a run on another machine")
    failing = shell("printf 't,q1\\n0,1\\n1,x\\n' | scarid filter -o a.csv")
    assert failing.status == 65
    assert failing.err.count("\n") == 1
    assert abandoned.exists()
    result = shell("scarid trajgen --duration 3 -q -o a.csv")
    assert result.status == 0
    assert ".a.csv.999999999.0123456789ab.part" in result.err
    assert not abandoned.exists()
    assert all(path.exists() for path in (*others, young))


@pytest.mark.parametrize("before", ["what was there before", None])
@pytest.mark.parametrize("failing", ["renamed", "a pipe that is closed"])
def test_of_several_outputs_none_is_left_when_the_last_one_fails(
    before: str | None,
    failing: str,
    scarid: Run,
    samples: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Whatever was there before is there again."""
    outputs = [tmp_path / name for name in ("p.parquet", "trace.parquet", "state.npz")]
    for path in outputs:
        if before:
            path.write_text(before)
    renamed = []

    def replace(self: Path, target: Path) -> Path:
        if self.suffix == ".part":
            renamed.append(target)
            if failing == "renamed" and len(renamed) == len(outputs):
                raise OSError(errno.EACCES, "Permission denied")
        os.replace(self, target)  # noqa: PTH105
        return target

    monkeypatch.setattr(Path, "replace", replace)
    main = "/dev/full" if failing != "renamed" else outputs[0]
    motion = tmp_path / "motion.parquet"
    result = scarid("differentiate", samples / "scara2.csv", "-o", motion)
    assert result.status == 0
    renamed.clear()
    words = ("--trace", outputs[1], "--save", outputs[2], "-o", main, "--format", "arrow")
    result = scarid("identify", "-q", motion, *words)
    assert result.status == 74
    assert result.err.count("\n") == 1
    left = {path.name: path.read_text() for path in tmp_path.iterdir() if path != motion}
    assert left == ({path.name: before for path in outputs} if before else {})


def test_of_several_outputs_nothing_else_is_left(
    scarid: Run, samples: Path, tmp_path: Path
) -> None:
    motion, state = tmp_path / "motion.parquet", tmp_path / "state.npz"
    assert scarid("differentiate", samples / "scara2.csv", "-o", motion).status == 0
    for _ in range(2):
        words = ("--save", state, "-o", tmp_path / "p.csv")
        assert scarid("identify", motion, *words).status == 0
    assert {path.name for path in tmp_path.iterdir()} == {"motion.parquet", "state.npz", "p.csv"}


@pytest.mark.parametrize(
    ("kind", "end"),
    [
        (StreamWriter, b"\xff\xff\xff\xff\0\0\0\0"),
        (FileWriter, b"ARROW1"),
        (ParquetWriter, b"PAR1"),
    ],
)
def test_a_table_that_is_broken_off_is_not_taken_for_a_whole_one(
    kind: type[StreamWriter | FileWriter | ParquetWriter], end: bytes
) -> None:
    """The mark at the end of its format is missing."""
    batch = pa.record_batch([np.arange(100_000.0)], ["t"])  # more than a group of a file
    whole, broken = io.BytesIO(), io.BytesIO()
    for out in (whole, broken):
        writer = kind(out.write, batch.schema)  # type: ignore[arg-type]
        writer.write(batch)
        writer.close() if out is whole else writer.abort()
    assert len(broken.getvalue()) > 1000
    assert whole.getvalue().endswith(end)
    assert not broken.getvalue().endswith(end)


def test_a_report_that_fails_leaves_no_folder_of_figures(
    scarid: Run, samples: Path, tmp_path: Path
) -> None:
    (tmp_path / "file").write_text("not a folder")
    words = ("--figures", tmp_path / "none")
    assert scarid("report", samples / "scara2.parameters.csv", *words).status == 0
    assert not (tmp_path / "none").exists() or list((tmp_path / "none").iterdir())
    result = scarid("report", samples / "scara2.csv", "--figures", tmp_path / "file")
    assert result.status == 74
    words = ("--figures", tmp_path / "figures", "--html", "/dev/full")
    assert scarid("report", samples / "scara2.csv", *words).status == 74
    assert not (tmp_path / "figures").exists()


def test_an_output_to_closed_standard_output_by_its_path_is_a_failure(users_shell: Run) -> None:
    result = users_shell("scarid trajgen --duration 3 -q -o /dev/stdout >&-")
    assert result.status == 74
    assert result.err.count("\n") == 1


def test_standard_output_can_be_given_by_its_path(users_shell: Run) -> None:
    expected = users_shell("scarid trajgen --duration 3 -q")
    assert users_shell("scarid trajgen --duration 3 -q -o /dev/stdout | cat").out == expected.out


def test_a_folder_that_is_missing_is_named(shell: Run, tmp_path: Path) -> None:
    result = shell("scarid trajgen --duration 3 -o results/reference.csv")
    assert (result.status, result.out) == (74, "")
    assert result.err == (
        "scarid trajgen: results/reference.csv: there is no folder results; make it first\n"
    )
    assert list(tmp_path.iterdir()) == []
