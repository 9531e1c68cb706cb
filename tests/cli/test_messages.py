"""Messages name the right place, say what is true, and cannot command a terminal."""

from __future__ import annotations

import errno
import os
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from conftest import Result, refused
from unit.arms import URDF

from scarid_cli.__main__ import _flushed

Run = Callable[..., Result]

ROWS = [f"{k / 100},{k},{k * 0.5}" for k in range(100_000)]  # several blocks of the reader


def log_with(tmp_path: Path, row: int, cells: bytes) -> Path:
    """A log in which a row (from 1) is replaced."""
    lines = [row.encode() for row in ROWS]
    lines[row - 1] = cells
    log = tmp_path / "log.csv"
    log.write_bytes(b"t,q1,note\n" + b"".join(line + b"\n" for line in lines))
    return log


@pytest.mark.parametrize("row", [1, 2, 90_000, 100_000])
@pytest.mark.parametrize(
    ("cell", "shown"),
    [
        (b"1_000", "'1_000'"),
        ("\u0663".encode(), "'\u0663'"),
        (b"1.5\xc2\xa0", "'1.5\\xa0'"),
        (b'""', "''"),
        (b"0x10", "'0x10'"),
        (b"\x1b[31m", "'\\x1b[31m'"),
        (b"9" * 70 + b"x", f"'{'9' * 60}'..."),
    ],
)
def test_a_cell_that_is_no_number_is_named_by_its_row_in_the_file_and_its_column(
    row: int, cell: bytes, shown: str, scarid: Run, tmp_path: Path
) -> None:
    """Also one that Python's float takes and Arrow does not."""
    log = log_with(tmp_path, row, b"0.5," + cell + b",1")
    result = scarid("filter", "--columns", "q1", log, "-o", tmp_path / "out.csv")
    refused(result, 65, f"{log}, row {row}, column q1: found {shown}, expected a number")


def test_a_row_is_counted_in_the_file_after_empty_lines_and_quoted_line_breaks(
    scarid: Run, tmp_path: Path
) -> None:
    log = tmp_path / "log.csv"
    log.write_bytes(b'# made\nt,name,q1\r\n0,"a\nb",1\r\n\r\n1,"c ""d""",2\r\n2,x,bad\r\n')
    result = scarid("info", log)
    refused(result, 65, "row 3, column q1: found 'bad', expected a number")


def test_text_that_is_not_utf8_is_named_by_its_row_and_column(scarid: Run, tmp_path: Path) -> None:
    log = tmp_path / "log.csv"
    log.write_bytes(b"t,name\n0,a\n1,\xff\n")
    refused(scarid("info", log), 65, "row 2, column name: found", "expected text in UTF-8")


@pytest.mark.parametrize("kind", ["parquet", "arrow", "arrow-file"])
@pytest.mark.parametrize("compression", [None, "zstd"])
def test_an_input_that_is_damaged_far_inside_is_bad_data_and_is_named(
    kind: str, compression: str | None, scarid: Run, tmp_path: Path
) -> None:
    """Not a failure of the output, which has rows by then."""
    log, out = tmp_path / "log", tmp_path / "out.csv"
    t = np.arange(60_000) / 1000.0
    table = pa.table({"t": t, "q1": np.sin(t)})
    if kind == "parquet":
        pq.write_table(table, log, row_group_size=5000, compression=compression)
    else:
        options = pa.ipc.IpcWriteOptions(compression=compression)
        new = pa.ipc.new_stream if kind == "arrow" else pa.ipc.new_file
        with new(log, table.schema, options=options) as writer:
            writer.write_table(table, max_chunksize=5000)
    content = log.read_bytes()
    rng = np.random.default_rng(0)
    for place in rng.integers(len(content) // 2, int(0.9 * len(content)), 8):
        log.write_bytes(content[:place] + bytes(64) + content[place + 64 :])
        result = scarid("convert", log, "-o", out)
        assert result.status in (0, 65)  # without checksums, other numbers are still numbers
        if result.status:
            refused(result, 65, str(log))


def test_a_full_disk_for_the_temporary_copy_of_a_pipe_is_a_failure_of_the_system(
    scarid: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A Parquet file can be read only from its end."""
    log = tmp_path / "log.parquet"
    pq.write_table(pa.table({"t": [0.0, 1.0], "q1": [0.0, 1.0]}), log)

    def full(*_: object) -> object:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(tempfile, "TemporaryFile", full)
    reading, writing = os.pipe()
    os.write(writing, log.read_bytes())
    os.close(writing)
    result = scarid("convert", f"/dev/fd/{reading}")
    refused(result, 74, f"/dev/fd/{reading}: no temporary copy", "No space left", "TMPDIR")
    os.close(reading)


@pytest.mark.parametrize("output", ["> /dev/full", ">> old.csv 2> /dev/full"])
def test_nothing_is_said_to_be_unwritten_that_may_have_been_written(
    output: str, shell: Run, tmp_path: Path
) -> None:
    (tmp_path / "bad.csv").write_text("".join(["t,q1\n", *(f"{k},1\n" for k in range(9)), "x,1\n"]))
    assert "nothing was written" not in shell(f"scarid trajgen --duration 3 {output}").err
    assert "nothing was written" not in shell(f"scarid filter bad.csv {output}").err


EVIL = "\x1b]0;title\x07\x1b[31m\u202eq\x9b"
SEEN = "\\x1b]0;title\\x07\\x1b[31m\\u202eq\\x9b"


def evil_table(tmp_path: Path) -> Path:
    """A table that tries to command the terminal wherever it can."""
    history = f'[{{"command": "{EVIL}", "version": "{EVIL}", "inputs": {{"{EVIL}": "{EVIL}"}}}}]'
    document = f'{{"history": {history}, "robot": "{EVIL}", "extra": {{"{EVIL}": "{EVIL}"}}}}'
    meta = {b"scarid": document.encode().replace(b"\x1b", b"\\u001b").replace(b"\x07", b"\\u0007")}
    path = tmp_path / f"{EVIL}.parquet"
    field = pa.field(EVIL, pa.float64(), metadata={"unit": EVIL})
    schema = pa.schema([pa.field("t", pa.float64()), pa.field("q1", pa.float64()), field])
    t = np.arange(50) / 100.0
    pq.write_table(pa.table([t, t, t], schema=schema.with_metadata(meta)), path)
    return path


@pytest.mark.parametrize(
    "command",
    [
        "info",
        "check",
        "identify",
        "differentiate -v -o out.csv",
        "filter --columns none",
        "convert --map x=y",
        "robot check",
    ],
)
def test_no_control_character_of_an_input_reaches_the_terminal(
    command: str, scarid: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    result = scarid(*command.split(), evil_table(tmp_path).name)
    assert SEEN in result.out + result.err
    assert all(c.isprintable() or c == "\n" for c in result.out + result.err)


def test_a_file_whose_name_is_no_text_is_described(scarid: Run, tmp_path: Path) -> None:
    path = os.fsencode(tmp_path) + b"/log\xff.csv"
    Path(os.fsdecode(path)).write_text("t,q1\n0,1\n1,2\n")
    assert "log\\udcff.csv" in scarid("info", os.fsdecode(path)).out


@pytest.mark.parametrize("name", [".csv", ".parquet", "folder/.PARQUET"])
def test_an_extension_alone_is_no_name_of_an_output(
    name: str, scarid: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As -o "$NAME.parquet" gives it where the variable is not set."""
    monkeypatch.chdir(tmp_path)
    refused(scarid("trajgen", "-o", name), 2, f"{name}: an extension without a name")


@pytest.mark.parametrize("name", ["a\nb", "a\rb", "", " a", "a ", "#a", "\ufeffa", "a\0b"])
def test_a_column_that_csv_would_not_give_back_is_refused(
    name: str, scarid: Run, tmp_path: Path
) -> None:
    log, out = tmp_path / "log.parquet", tmp_path / "out.csv"
    pq.write_table(pa.table([[0.0, 1.0]] * 3, names=[name, "t", "q1"]), log)
    refused(scarid("convert", log, "-o", out), 65, f"column 1: found the name {name!r}")
    assert scarid("convert", log, "-o", tmp_path / "out.arrow").status == 0


def parameters(tmp_path: Path, names: list[str]) -> Path:
    """A table of parameters with these names."""
    path = tmp_path / "method.csv"
    header = "parameter,unit,estimate,standard_error,relative_deviation\n"
    path.write_text(header + "".join(f"{name},kg,1.0,0.1,10.0\n" for name in names))
    return path


@pytest.mark.parametrize("words", [(), ("--markdown", "-")])
def test_no_control_character_of_a_parameter_reaches_the_terminal(
    words: tuple[str, ...], scarid: Run, tmp_path: Path
) -> None:
    result = scarid("report", parameters(tmp_path, [EVIL]), *words, "--title", EVIL)
    assert "u202eq" in result.out
    assert all(c.isprintable() or c == "\n" for c in result.out)


def test_marks_of_markdown_in_names_are_text(scarid: Run, tmp_path: Path) -> None:
    names = ["a|b", "<script>", "[x](y)", "_a_", "__b__", "`c`", "~~d~~", "&lt;", "**e**", "a_b"]
    found = scarid("report", parameters(tmp_path, names), "--markdown", "-").out
    shown = ["a\\|b", "\\<script>", "[x\\](y)", "\\_a\\_", "\\_\\_b\\_\\_", "\\`c\\`"]
    for text in (*shown, "\\~\\~d\\~\\~", "\\&lt;", "\\*\\*e\\*\\*", "a_b"):
        assert f"| {text} " in found


URDFS = {
    "mass of a link": ('<mass value="2"/>', '<mass value="x"/>', "mass [x] is not a float"),
    "no mass": ('<mass value="2"/>', "", "must have a mass"),
    "inertia": ('ixx="0.1"', 'ixx="0,1"', "ixx is not a valid double"),
    "axis": ('<axis xyz="0 1 0"/>', '<axis xyz="0 1"/>', "found 2 elements but 3 expected"),
    "axis of no direction": ('<axis xyz="0 1 0"/>', '<axis xyz="0 0 0"/>', "joint a is 0 0 0"),
    "kind of a joint": ('type="revolute"', 'type="hinge"', "no known type [hinge]"),
    "child": ('<child link="two"/>', '<child link="none"/>', "child link [none]"),
    "XML": ("</robot>", "", "no element found"),
}


@pytest.mark.parametrize("what", URDFS)
def test_what_the_reader_of_urdfs_cannot_read_is_one_line_of_ours(
    what: str, scarid: Run, tmp_path: Path
) -> None:
    """It prints lines of its own, and goes on without what it could not read."""
    old, new, reason = URDFS[what]
    robot = tmp_path / "arm.urdf"
    robot.write_text(URDF.replace("TYPE", "revolute").replace(old, new, 1))
    refused(scarid("robot", "check", robot), 2, f"{robot}: not a URDF", reason)


def test_shapes_that_the_reader_of_urdfs_does_not_know_are_no_matter(
    scarid: Run, tmp_path: Path
) -> None:
    shape = "<geometry><cone/></geometry>"
    more = f"<visual>{shape}</visual><collision>{shape}</collision>"
    robot = tmp_path / "arm.urdf"
    text = URDF.replace("TYPE", "revolute").replace('<link name="two">', f'<link name="two">{more}')
    robot.write_text(text.replace("</robot>", '<material name="m"/></robot>'))
    result = scarid("robot", "check", robot)
    assert (result.status, result.err) == (0, "")


def test_warnings_of_libraries_are_not_printed(shell: Run, tmp_path: Path) -> None:
    """Numbers so large that their squares overflow; numpy would warn."""
    rows = "".join(f"{k / 100},{(-1) ** k * 1e300},{k}\n" for k in range(200))
    (tmp_path / "log.csv").write_text(f"t,q1,tau1\n{rows}")
    for command in ("differentiate", "check --robot emps", "filter", "info", "tune"):
        found = shell(f"scarid {command} log.csv > /dev/null").err
        assert "Warning" not in found
        assert all(line.startswith("scarid ") for line in found.splitlines())


def test_a_run_that_fails_leaves_no_descriptor_open(scarid: Run, tmp_path: Path) -> None:
    descriptors = Path("/proc/self/fd")
    if not descriptors.is_dir():
        pytest.skip("this system does not list the descriptors of a process")
    bad = tmp_path / "bad.csv"
    bad.write_text("t,q1\n0,1\n0.1,x\n")
    opened = []
    for name in ("a.csv", "b.parquet", "c.arrow", "d.arrows") * 2:
        assert scarid("filter", bad, "-o", tmp_path / name).status == 65
        opened.append(len(list(descriptors.iterdir())))
    assert opened[4:] == opened[3:4] * 4  # the first ones open what libraries keep


@pytest.mark.parametrize("kind", ["nothing", "\u00c9", "joint"])
def test_a_kind_that_is_none_opens_no_file(kind: str, scarid: Run, tmp_path: Path) -> None:
    log = tmp_path / "log.parquet"
    meta = {b"scarid": f'{{"kind": "{kind}", "history": []}}'.encode()}
    pq.write_table(pa.table({"t": [0.0, 1.0], "q1": [0.0, 1.0]}).replace_schema_metadata(meta), log)
    result = scarid("info", log)
    assert (result.status, result.err) == (0, "")
    assert "measurement (inferred from its columns)" in result.out
    refused(scarid("report", log), 65, str(log))


@pytest.mark.parametrize(("status", "expected"), [(0, 141), (65, 65), (2, 2)])
def test_a_reader_that_is_gone_at_the_end_does_not_hide_a_failure(
    status: int, expected: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Gone:
        def flush(self) -> None:
            raise BrokenPipeError

    with monkeypatch.context() as patched:
        patched.setattr("sys.stdout", Gone())
        patched.setattr("os.dup2", lambda *_: None)
        found = _flushed(status)
    assert found == expected
