"""Text logs as measuring programs write them: lines before the header, units below it, dates."""

from __future__ import annotations

import os
import re
import struct
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Timer

import numpy as np
import pytest
from bags import table
from conftest import Result, Shell, refused
from hypothesis import given
from hypothesis import strategies as st

from scarid_cli.io.bytesource import ByteSource
from scarid_cli.io.csvio import read_csv
from scarid_cli.io.foreign import TranslatedCsv
from scarid_cli.io.notation import notation_of

Run = Callable[..., Result]

ROWS = 30
T = 0.01 * np.arange(ROWS)
VALUES = np.random.default_rng(5).standard_normal((ROWS, 4))
LOG = np.column_stack((T, VALUES))
ORDER = ["t", "q1", "q2", "tau1", "tau2"]
DEGREES = np.array([1.0, *[180.0 / np.pi] * 2, 1.0, 1.0])


@pytest.fixture(autouse=True)
def inside(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def written(names: str, first: list[str] | None = None, rows: np.ndarray = LOG) -> str:
    """A log with these names, whose clock has these texts."""
    clock = first or [f"{t:.17g}" for t in rows[:, 0]]
    lines = [
        ",".join([t, *(f"{x:.17g}" for x in row[1:])]) for t, row in zip(clock, rows, strict=True)
    ]
    return "\n".join([names, *lines]) + "\n"


def converted(shell: Shell, tmp_path: Path, text: str | bytes, options: str = "") -> np.ndarray:
    """The columns t, q1, q2, tau1 and tau2 that `scarid convert` makes of a log."""
    data = text if isinstance(text, bytes) else text.encode()
    (tmp_path / "log.csv").write_bytes(data)
    done = shell(f"scarid convert {options} log.csv")
    assert done.status == 0, done.err
    names, values = table(done.out)
    return np.asarray(values[:, [names.index(name) for name in ORDER]])


CHARACTERS = st.characters(codec="ascii", exclude_categories=["Cc"], exclude_characters=',;| #%"')
LINE = st.text(CHARACTERS, min_size=1, max_size=9)
PAIR = st.tuples(LINE, LINE).map(lambda pair: f"{pair[0]};x{pair[1]}")  # no rows of numbers
BEFORE = st.lists(st.one_of(LINE, PAIR), max_size=9)
UNITS = ("s", "rad", "rad", "Nm", "Nm")


@given(BEFORE, st.sampled_from([", .", "; .", "; ,", "\t .", "\t ,", "  .", "  ,"]), st.data())
def test_a_table_is_found_behind_any_lines_and_above_units(
    before: list[str], marks: str, data: st.DataObject
) -> None:
    separator, decimal = marks[0], marks[-1]
    units = UNITS if data.draw(st.booleans()) else ()
    lines = [*before, *data.draw(st.sampled_from([[], [""]])), separator.join(ORDER)]
    lines += [separator.join(units)] if units else []
    lines += [separator.join(f"{x:.6f}".replace(".", decimal) for x in row) for row in LOG]
    with TemporaryDirectory() as folder:
        path = Path(folder, "log")
        path.write_text("\n".join(lines) + "\n")
        source = ByteSource.open(str(path))
        notation = notation_of(source, None, by_name=False)
        found = read_csv(source if notation.plain else TranslatedCsv(source, notation))
        values = np.hstack([np.array([batch.column(n) for n in ORDER]) for batch in found.batches])
    assert notation.units == units
    np.testing.assert_allclose(values.T, LOG, atol=1e-6)


def test_a_live_source_with_other_separators_is_not_waited_for() -> None:
    """The pipe stays open until its rows are read, or for so long that they were waited for."""
    read, write = os.pipe()
    source, pipe = ByteSource(read, "pipe"), os.fdopen(write, "wb", buffering=0)
    late = Timer(10.0, pipe.close)
    late.start()
    pipe.write(written(",".join(ORDER)).replace(",", ";").encode())
    live = TranslatedCsv(source, notation_of(source, None, by_name=False))
    assert live.read_some(1 << 16).decode() == written(",".join(ORDER))
    assert not pipe.closed
    late.cancel()
    pipe.close()
    source.close()


@pytest.mark.parametrize("brackets", ["{}", "[{}]", "({})"])
def test_units_below_the_header_are_used(brackets: str, shell: Shell, tmp_path: Path) -> None:
    below = ",".join(brackets.format(unit) for unit in ("ms", "deg", "deg", "mNm", "mNm"))
    scale = np.array([1e3, *DEGREES[1:3], 1e3, 1e3])
    text = written(",".join(ORDER) + "\n" + below, rows=LOG * scale)
    np.testing.assert_allclose(converted(shell, tmp_path, text), LOG, rtol=1e-12)


@pytest.mark.parametrize(
    "names",
    [
        "Zeit [s],Achsposition A1 [Grad],Achsposition A2 [Grad],Moment A1 [Nm],Moment A2 [Nm]",
        "Zeitstempel,Winkel 1 [deg],Winkel 2 [deg],Drehmoment 1,Drehmoment 2",
        "temps,position axe 1 (deg),position axe 2 (deg),couple axe 1,couple axe 2",
        "tiempo,posición_1_deg,posición_2_deg,momento_1,momento_2",
        "t,θ1 [deg],θ2 [deg],τ1,τ2",
        "tempo,posizione giunto 1 [°],posizione giunto 2 [°],coppia giunto 1,coppia giunto 2",
    ],
)
def test_words_of_other_languages_are_known(names: str, shell: Shell, tmp_path: Path) -> None:
    found = converted(shell, tmp_path, written(names, rows=LOG * DEGREES))
    np.testing.assert_allclose(found, LOG, rtol=1e-12)


CLOCKS = {
    "twelve hours": [f"11:59:{59 + t:05.2f} am" if t < 1 else "" for t in T],
    "noon": [f"12:00:{t:05.2f} PM" for t in T],
    "month first": [f"11/27/2026 9:59:{59 + t:05.2f} AM" for t in T],
    "day first": [f"27/11/2026 09:59:{59 + t:05.2f}" for t in T],
    "a difference of times": [f"0 days 00:00:{t:09.6f}" for t in T],
    "a day later": [
        f"1 day 23:59:{59.9 + t:05.2f}" if t < 0.095 else f"2 days 00:00:{t - 0.1:05.2f}" for t in T
    ],
    "milliseconds behind a colon": [f"11:59:50:{round(1e3 * t):03d}" for t in T],
    "minutes": [f"59:{59 + t:05.2f}" for t in T],
    "duration": [f"{t:.2f} sec" for t in T],
    "milliseconds": [f"{round(1e3 * t)} ms" for t in T],
    "time of the day": [f"9:59:{59 + t:05.2f}" if t < 1 else "" for t in T],
    "German date": [f"27.11.2026 09:59:{59 + t:05.2f}" for t in T],
    "slashes": [f"2026/1/7 9:59:{59 + t:05.2f}" for t in T],
    "ISO": [f"2026-11-27T09:59:{59 + t:05.2f}" for t in T],
}


@pytest.mark.parametrize("name", ["time", "t"])
@pytest.mark.parametrize("kind", CLOCKS)
def test_texts_that_are_times_become_seconds(
    kind: str, name: str, shell: Shell, tmp_path: Path
) -> None:
    found = converted(shell, tmp_path, written(",".join([name, *ORDER[1:]]), CLOCKS[kind]))
    np.testing.assert_allclose(found, LOG, atol=1e-9)


def test_names_in_two_lines_are_joined(shell: Shell, tmp_path: Path) -> None:
    """As of merged cells: what stands above an empty cell is to its left."""
    names = ",position,,effort,\ntime,shoulder,elbow,shoulder,elbow"
    np.testing.assert_allclose(converted(shell, tmp_path, written(names)), LOG, rtol=1e-12)


@pytest.mark.parametrize("unit", ["%", "pct", "percent", "counts", "ticks"])
def test_a_unit_that_only_the_device_knows_is_asked_for(
    unit: str, shell: Shell, tmp_path: Path
) -> None:
    names = f"time,pos1,pos2,torque1_{unit},torque2_{unit}"
    (tmp_path / "log.csv").write_text(written(names))
    told = shell("scarid convert log.csv").err
    assert f"torque1_{unit} does not say what one {unit} is" in told
    options = f"--map t=time --map 'q*=pos' --map 'tau*=torque*_{unit}' --unit 'tau*=0.5 N m'"
    found = converted(shell, tmp_path, written(names), options)
    np.testing.assert_allclose(found, LOG * [1, 1, 1, 0.5, 0.5], rtol=1e-12)


def test_a_time_of_the_day_goes_on_at_midnight(shell: Shell, tmp_path: Path) -> None:
    t = 0.01 * np.arange(100)
    seconds = (86399.5 + t) % 86400
    clock = [f"{x // 3600:02.0f}:{x % 3600 // 60:02.0f}:{x % 60:05.2f}" for x in seconds.tolist()]
    rows = np.column_stack((t, np.random.default_rng(6).standard_normal((100, 4))))
    found = converted(shell, tmp_path, written(",".join(["time", *ORDER[1:]]), clock, rows))
    np.testing.assert_allclose(found, rows, atol=1e-9)


@pytest.mark.parametrize("late", [0.0, 1e-4])
def test_a_clock_beside_each_signal_is_one_if_all_are_equal(
    late: float, shell: Shell, tmp_path: Path
) -> None:
    """As oscilloscopes of drives export them; where one differs, its first row is told."""
    names = ["Time [ms]", "Pos 1 [deg]", "Time [ms]", "Pos 2 [deg]"]
    names += ["Time [ms]", "Torque 1", "Time [ms]", "Torque 2"]
    scaled = LOG * np.array([1e3, *DEGREES[1:]])
    rows = np.repeat(scaled[:, :1], 8, axis=1)
    rows[:, 1::2] = scaled[:, 1:]
    rows[7:, 4] += 1e3 * late
    text = "\n".join([";".join(names), *(";".join(f"{x:.17g}" for x in row) for row in rows)])
    if not late:
        found = converted(shell, tmp_path, text + "\n")
        np.testing.assert_allclose(found, LOG, rtol=1e-12)
        return
    (tmp_path / "log.csv").write_text(text + "\n")
    done = shell("scarid convert log.csv")
    assert done.status == 65
    assert "row 8, column Time [ms]: found 4 columns of this name, with other values" in done.err


def test_a_text_among_times_is_refused_with_its_row(scarid: Run, tmp_path: Path) -> None:
    clock = [*CLOCKS["duration"][:-1], "soon"]
    Path("log.csv").write_text(written(",".join(["time", *ORDER[1:]]), clock))
    result = scarid("convert", "log.csv", "-o", "out.csv")
    assert result.status == 65
    assert f"row {ROWS}, column time: found 'soon', expected a date such as 0.00 sec" in result.err


@pytest.mark.parametrize("word", ["", "NaN", "None", "null", "-", "N/A"])
def test_a_first_value_that_is_missing_makes_no_column_of_texts(
    word: str, shell: Shell, tmp_path: Path
) -> None:
    lines = written("time,pos_1,pos_2,torque_1,torque_2").splitlines()
    lines[1] = ",".join([*lines[1].split(",")[:3], word, word])
    (tmp_path / "log.csv").write_text("\n".join(lines) + "\n")
    done = shell("scarid convert log.csv -o log.parquet && scarid info log.parquet")
    assert done.status == 0, done.err
    assert re.search(r"tau1 +double", done.out)
    done = shell("scarid identify log.parquet -o p.csv")
    assert "row 1, column tau1: found " in done.err


def test_a_text_where_numbers_belong_is_refused_with_its_row(scarid: Run) -> None:
    text = written("time,pos_1,pos_2,torque_1,torque_2").splitlines()
    text[1] = text[1].rsplit(",", 1)[0] + ",off"
    Path("log.csv").write_text("\n".join(text) + "\n")
    result = scarid("convert", "log.csv", "-o", "out.csv")
    assert result.status == 65
    assert "row 1, column torque_2: found 'off', expected a number" in result.err
    assert not Path("out.csv").exists()


def test_an_array_of_numpy_takes_names(scarid: Run, shell: Shell, tmp_path: Path) -> None:
    np.save(tmp_path / "log.npy", LOG)
    result = shell("scarid convert log.npy")
    assert result.status == 2
    assert "name them: --header t,q1,q2,tau1,tau2" in result.err
    assert "4 names for 5 columns" in shell("scarid convert log.npy --header t,q1,q2,tau1").err
    for options in ("--header t,q1,q2,tau1,tau2", "--map t=log1 --map q1=log2 --map q2=log3 "
                    "--map tau1=log4 --map tau2=log5"):  # fmt: skip
        done = shell(f"scarid convert log.npy {options}")
        assert done.status == 0, done.err
        names, values = table(done.out)
        np.testing.assert_array_equal(values[:, [names.index(name) for name in ORDER]], LOG)


def test_an_array_of_numpy_with_fields_has_names(shell: Shell, tmp_path: Path) -> None:
    np.save(tmp_path / "log.npy", np.array([*map(tuple, LOG)], [(name, "f8") for name in ORDER]))
    done = shell("scarid convert log.npy")
    assert done.status == 0, done.err
    np.testing.assert_array_equal(table(done.out)[1], LOG)


STARTS = {
    "a.dat": (b"\x89HDF\r\n\x1a\n" + bytes(40), "call it NAME.h5"),
    "b.dat": (b"\x93NUMPY\x01\x00v\x00{'descr': 1}\n", "call it NAME.npy"),
    "c.xlsx": (b"PK\x03\x04" + bytes(40), "save the sheet as CSV"),
    "d.xls": (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(40), "save the sheet as CSV"),
    "e.pkl": (b"\x80\x04\x95" + struct.pack("<Q", 12) + b"t\n", "a pickle, which can run any"),
    "f.tdms": (b"TDSm\x0e\0\0\0", "export it as CSV"),
}


@pytest.mark.parametrize("name", STARTS)
@pytest.mark.parametrize("command", ["convert", "identify"])
def test_files_of_other_formats_are_known_by_their_first_bytes(
    name: str, command: str, scarid: Run
) -> None:
    start, advice = STARTS[name]
    Path(name).write_bytes(start)
    result = scarid(command, name, "-o", "out.csv")
    assert result.status == 65
    assert result.err.count("\n") == 1
    assert advice in result.err


LACKING = {
    "time,axis0.encoder.pos_estimate,axis1.encoder.pos_estimate,axis0.Iq_measured,axis1.Iq_measured":
        "name them, as in --map t=time --map 'q*=axis*.encoder.pos_estimate' "
        "--map 'current*=axis*.Iq_measured'",
    "tick,pos_1,pos_2,tau_est_1,tau_est_2":
        "no torques: perhaps --map 'tau*=tau_est_*'; no clock: perhaps --map t=tick",
    "pos_1,pos_2,torque_1,torque_2,x": "no clock: give --rate HZ",
    "time,cmd_pos_1,cmd_pos_2,torque_1,torque_2": "--map t=time --map 'tau*=torque_*'",
    "time,rob1_1,rob1_2,torque_rob1_1,torque_rob1_2":
        "--map t=time --map 'q*=rob1_*' --map 'tau*=torque_rob1_*'",
    "Time,A1,A2,MomentA1,MomentA2": "--map t=Time --map 'q*=A*' --map 'tau*=MomentA*'",
    "time,q1,q2,u1,u2": "no torques: perhaps --map 'tau*=u*'",
    "time,qpos1,qpos2,ctrl1,ctrl2": "no torques: perhaps --map 'tau*=ctrl*'",
    "time,q1,q2,temp1,temp2": "no torques\n",
    "a,b,c,d,e": "as in --map q1=a",
}  # fmt: skip


@pytest.mark.parametrize("names", LACKING)
def test_what_a_log_lacks_is_said_with_the_columns_that_may_hold_it(
    names: str, scarid: Run
) -> None:
    Path("log.csv").write_text(written(names))
    assert LACKING[names] in scarid("convert", "log.csv", "-o", "out.csv").err


def test_advised_options_are_taken(shell: Shell, tmp_path: Path) -> None:
    names = "tick,motor_pos_0,motor_pos_1,tau_est_0,tau_est_1"
    (tmp_path / "log.csv").write_text(written(names))
    done = shell("scarid convert log.csv -o out.csv")
    options = done.err.partition("as in ")[2].strip()
    assert converted(shell, tmp_path, written(names), options).tolist() == LOG.tolist()


def test_a_log_that_wraps_is_refused_for_this_reason(scarid: Run, samples: Path) -> None:
    rows = np.genfromtxt(samples / "scara2.csv", delimiter=",", names=True)
    columns = {name: rows[name] for name in ORDER}
    for name in ("q1", "q2"):
        columns[name] = np.degrees(columns[name]) % 360.0
    text = np.column_stack([*columns.values()])
    np.savetxt("log.csv", text, "%.9g", ",", header=",".join(columns), comments="")
    result = scarid("identify", "log.csv", "-o", "out.csv")
    assert result.status == 65
    assert "wraps: q1 leaps by 360 in 2 rows" in result.err
    assert "`scarid convert --unwrap`" in result.err
    assert "too few rows are away from reversals" in result.err


def test_a_unit_that_is_not_known_is_asked_for_wherever_the_column_is_named(
    shell: Shell, tmp_path: Path
) -> None:
    """What convert suggests does not end in values of another unit."""
    (tmp_path / "log.csv").write_text(
        "t,pos 1 [deg],pos 2 [deg],moment 1 [%],moment 2 [%]\n0,1,2,3,4\n1,2,3,4,5\n"
    )
    told = shell("scarid convert log.csv").err
    assert "--map 'tau*=moment * [%]' --unit 'tau*=X N m'" in told
    named = "scarid convert -q --map 'q*=pos * [deg]' --map 'tau*=moment * [%]'"
    refused(shell(f"{named} log.csv"), 2, "tau1=moment 1 [%]", "what one % is", "--unit 'tau1=")
    stated = shell(f"{named} --unit 'tau*=0.5 N m' log.csv")
    assert stated.out.splitlines()[1].endswith(",1.5,2")


def test_currents_that_a_description_calls_torques_are_asked_for_their_constants(
    shell: Shell, tmp_path: Path, samples: Path
) -> None:
    (tmp_path / "arm.urdf").write_text((samples / "arm.urdf").read_text())
    (tmp_path / "log.csv").write_text("enc_a,enc_b,current_1,current_2\n1,2,3,4\n2,3,4,5\n")
    text = (samples / "arm.toml").read_text().replace('torques = "current"', "")
    text = text.replace('"i_a"', '"current_1"').replace('"i_b"', '"current_2"')
    (tmp_path / "arm.toml").write_text(text.replace(', "tau?" = "mA"', ""))
    for command in ("check", "identify", "convert"):
        found = shell(f"scarid {command} --robot arm.toml log.csv")
        refused(found, 2, "tau1 = 'current_1' is by its name a current", "torque_constant")
    (tmp_path / "arm.toml").write_text(text.replace('"mA"', '"0.05 N m"'))
    found = shell("scarid convert -q --robot arm.toml log.csv")
    torques = found.out.splitlines()[2].split(",")[3:]
    assert torques == ["0.2", "0.25"]


CHANNELS = ["fPosition1", "fPosition2", "fTorque1", "fTorque2"]
PROPERTIES = {
    "SymbolComment": "",
    "Data-Type": "REAL64",
    "SampleTime[ms]": "10",
    "Port": "851",
    "ScaleFactor": "1",
}


@pytest.mark.parametrize("properties", [0, 1, 3, 5])
@pytest.mark.parametrize("units", [None, ["deg", "deg", "(None)", "(None)"], ["(None)"] * 4])
def test_channels_of_a_scope_are_named_above_their_properties(
    properties: int, units: list[str] | None, shell: Shell, tmp_path: Path
) -> None:
    """Some of which are numbers in each column, and the last line says that it is the last."""

    def pairs(first: str, cells: list[str]) -> str:
        return "\t".join(f"{first}\t{cell}" for cell in cells)

    lines = ["Name\tScope Project", "File\tC:\\log.csv", "", pairs("Name", CHANNELS)]
    lines += [pairs(name, [cell] * 4) for name, cell in [*PROPERTIES.items()][:properties]]
    lines += [pairs("Unit", units), ""] if units else [""]
    scaled = LOG * np.array([1e3, *(DEGREES[1:] if units and units[0] == "deg" else [1.0] * 4)])
    for row in scaled.tolist():
        t, values = f"{row[0]:.17g}", [f"{x:.17g}".replace(".", ",") for x in row[1:]]
        lines.append("\t".join(f"{t.replace('.', ',')}\t{x}" for x in values))
    found = converted(shell, tmp_path, "\r\n".join([*lines, "EOF", ""]))
    np.testing.assert_allclose(found, LOG, rtol=1e-12)


@pytest.mark.parametrize("unit", ["deg", ""])
def test_a_file_of_labview_has_names_behind_its_header(
    unit: str, shell: Shell, tmp_path: Path
) -> None:
    def of_all(label: str, cell: str) -> str:
        return "\t".join([label, *[cell] * 4, ""])

    lines = ["LabVIEW Measurement\t", "Separator\tTab\t", "Multi_Headings\tNo\t",
             "***End_of_Header***\t", "\t", "Channels\t4\t\t\t\t", of_all("Samples", str(ROWS)),
             of_all("Date", "2026/01/02"), "\t".join(["Y_Unit_Label", unit, unit, "", "", ""]),
             of_all("X_Dimension", "Time"), of_all("X0", "0.0E+0"), of_all("Delta_X", "0.01"),
             "***End_of_Header***\t\t\t\t\t",
             "X_Value\tPos_1\tPos_2\tTorque_1\tTorque_2\tComment"]  # fmt: skip
    scaled = LOG * (DEGREES if unit else 1.0)
    lines += ["\t".join([*(f"{x:.17g}" for x in row), ""]) for row in scaled]
    (tmp_path / "log.lvm").write_text("\r\n".join([*lines, ""]))
    done = shell("scarid convert log.lvm | cut -d, -f1-5")
    names, values = table(done.out)
    assert names == ORDER
    np.testing.assert_allclose(values, LOG, rtol=1e-12)


def test_a_comment_has_the_names_of_rows_that_begin_with_nanoseconds(
    shell: Shell, tmp_path: Path
) -> None:
    clock = [str(1_609_060_336_768_428_032 + 10_000_000 * k) for k in range(ROWS)]
    found = converted(shell, tmp_path, written("#timestamp [ns],q1,q2,tau1,tau2", clock))
    np.testing.assert_allclose(found - [found[0, 0], 0, 0, 0, 0], LOG, atol=1e-6)


@given(st.data())
def test_a_header_stays_one_above_rows_that_lack_most_values(data: st.DataObject) -> None:
    """As of sources that write in turn: each row has the values of one of them."""
    groups = [[1, 2], [3, 4]]
    lines = [",".join(ORDER)]
    for row in LOG:
        own = data.draw(st.sampled_from(groups))
        missing = data.draw(st.sampled_from(["", "nan"]))
        lines.append(",".join(f"{x:.6f}" if k in (0, *own) else missing for k, x in enumerate(row)))
    with TemporaryDirectory() as folder:
        path = Path(folder, "log")
        path.write_text("\n".join(lines) + "\n")
        assert notation_of(ByteSource.open(str(path)), None, by_name=False).plain


@pytest.mark.parametrize(
    "text",
    ["<html><body>404</body></html>", '<?xml version="1.0"?>\n<robot/>\n', " <!DOCTYPE html>"],
)
@pytest.mark.parametrize("command", ["convert", "info", "identify --robot scara2"])
def test_a_page_is_no_table(text: str, command: str, shell: Shell, tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text(text)
    refused(shell(f"scarid {command} log.csv"), 65, "HTML or XML, and no table")


@pytest.mark.parametrize("option", ["-o foo/", "--tee foo/"])
def test_a_folder_is_no_output(option: str, shell: Shell, tmp_path: Path) -> None:
    """Nor is a link into a folder that is not there, which is named."""
    command = "tee" if "tee" in option else "filter --cutoff 10"
    words = option.replace("--tee ", "")
    found = shell(f"scarid {command} {words} < $SAMPLES/scara2.csv")
    assert (found.status, (tmp_path / "foo").exists()) == (74, False), found
    assert "foo/: a folder; name a file in it" in found.err
    (tmp_path / "link.csv").symlink_to("nowhere/log.csv")
    found = shell("scarid filter --cutoff 10 -o link.csv $SAMPLES/scara2.csv")
    assert f"there is no folder {tmp_path}/nowhere" in found.err


@pytest.mark.parametrize("start", [133_537_679_900_000_000, 638_000_000_000_000_000])
def test_ticks_of_100_ns_are_a_clock(start: int, shell: Shell, tmp_path: Path) -> None:
    """As Windows counts them since 1601, and .NET since the year 1."""
    clock = [str(start + 100_000 * k) for k in range(ROWS)]
    found = converted(shell, tmp_path, written(",".join(["timestamp", *ORDER[1:]]), clock))
    np.testing.assert_allclose(found, LOG, atol=1e-9)


@pytest.mark.parametrize("name", ["duration", "utime", "elapsed_ms_ticks"])
def test_what_may_be_a_clock_is_named(name: str, shell: Shell, tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text(written(",".join([name, *ORDER[1:]])))
    assert f"no clock: perhaps --map t={name}" in shell("scarid convert log.csv").err


def test_rows_of_single_values_are_to_be_pivoted(shell: Shell, tmp_path: Path) -> None:
    names = ",result,table,_time,_value,_field,joint"
    rows = [f",,0,2026-01-01T00:00:00Z,{x},position,a" for x in range(3)]
    text = "\n".join(["#group,false,false,false,false,true,true", names, *rows])
    (tmp_path / "log.csv").write_text(f"{text}\n")
    refused(shell("scarid convert log.csv"), 65, "as of InfluxDB", "|> pivot(rowKey")


@pytest.mark.parametrize(
    ("names", "proposed"),
    [
        ("current_tau_ext_{}", ""),
        ("tau_ext_hat_filtered_{}", ""),
        ("x_tau_est_{}", "x_tau_est_*"),
    ],
)
def test_an_external_torque_is_not_proposed(
    names: str, proposed: str, shell: Shell, tmp_path: Path
) -> None:
    """Nor what a filter made of one, where the joint's own torque is not in the log."""
    columns = ["t", "q1", "q2", *(names.format(i) for i in (1, 2))]
    (tmp_path / "log.csv").write_text(written(",".join(columns)))
    told = shell("scarid convert log.csv").err
    assert "no torques" in told or not proposed
    assert ("--map 'tau*=" in told) == bool(proposed), told
    assert proposed in told


@pytest.mark.parametrize("coding", ["utf-8", "utf-8-sig", "latin-1", "cp1252", "utf-16"])
@pytest.mark.parametrize("separator", [",", ";"])
def test_a_degree_is_one_in_every_coding(
    coding: str, separator: str, shell: Shell, tmp_path: Path
) -> None:
    names = ["t", "Winkel 1 [°]", "Winkel 2 [°]", "Moment 1 [Nm]", "Moment 2 [Nm]"]
    text = written(",".join(names), rows=LOG * DEGREES).replace(",", separator)
    np.testing.assert_allclose(converted(shell, tmp_path, text.encode(coding)), LOG, rtol=1e-12)
