"""Foreign files: CSV in other notations, NumPy's .npz and MATLAB's .mat files."""

from __future__ import annotations

import re
import struct
from collections.abc import Collection, Sequence
from os import SEEK_END
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa

from scarid_cli.errors import BadData, ScaridError, UsageFault, bad_data
from scarid_cli.io.bytesource import ByteSource, Wrapped, max_batch, require_moderate
from scarid_cli.io.cells import csv_text
from scarid_cli.io.matfile import COPIES, TOO_LARGE
from scarid_cli.io.notation import SPACE, Notation, without_names
from scarid_cli.io.table import Metadata, Table, doubles
from scarid_cli.printable import printable

ARCHIVES = (".npz", ".npy", ".mat", ".h5", ".hdf5")
END_OF_ZIP = struct.Struct("<4s6xH10x")  # the last bytes: a mark, and how many files there are
MANY = 0xFFFF  # stands for a number that is elsewhere
COMMENTS = b"#%\r\n"  # that begin a line before the header, if it is not empty

END = re.compile(rb"\r?\n\s*EOF\s*\Z")  # the last line of some programs


class TranslatedCsv(Wrapped):
    """A text log in another notation, translated into plain CSV.

    It is translated byte by byte, so neither separator nor decimal mark may occur within a text.
    """

    def __init__(self, source: ByteSource, notation: Notation) -> None:
        super().__init__(source)
        decimal = "," if notation.decimal_comma else ""
        separator = "" if notation.separator == SPACE else notation.separator
        self._table = bytes.maketrans(
            (separator + decimal).encode(), (b"," if separator else b"") + b"." * len(decimal)
        )
        self._space = notation.separator == SPACE
        self._rest = b""
        source.drop_lines(notation.skip)
        source.drop_comments(COMMENTS)
        source.drop_lines(2 if notation.units or notation.two_lines else 0)
        if notation.header:
            self._ahead = csv_text([notation.header])

    def _fetch(self, size: int) -> bytes:
        data = self.source.read_some(size)
        if not self._space:
            data = data.translate(self._table)
            # Whether more comes is asked only behind such a line: a live source would wait.
            return END.sub(b"\n", data) if END.search(data) and not self.source.peek(1) else data
        ended = not data
        while not ended and b"\n" not in data:
            more = self.source.read_some(size)
            data, ended = data + more, not more
        block = self._rest + data
        end = len(block) if ended else block.rfind(b"\n") + 1
        self._rest = block[end:]
        lines = block[:end].translate(self._table).split(b"\n")
        return b"\n".join(b",".join(line.split()) for line in lines)


def read_archive(
    path: str, named: Collection[str] = (), header: Sequence[str] = ()
) -> tuple[Table, list[str], list[str]]:
    """The arrays of an .npz, .npy, .mat or HDF5 file as columns; a matrix `q` becomes q1, q2, ...

    The columns of the one matrix of an .npy file have the names of the `header`. If the arrays are
    not the columns of one table, only those are read that are `named`, by themselves or one of
    their columns; the second value are the names of those that are left out, and the third one are
    single numbers: `dt = 0.005`. An array that is not of real numbers, or whose numbers a double
    cannot hold exactly, is BadData, as is a file that cannot be read.
    """
    every = _read(path)
    arrays = {name: array for name, array in every.items() if array.size > 1}
    kept = {name: array for name, array in arrays.items() if {*_names(name, array)} & {*named}}
    if not kept or _are_a_table(arrays):
        kept = arrays
    columns: dict[str, Any] = {}
    for name, array in kept.items():
        own = _columns(path, name, array)
        if both := sorted({*own} & {*columns}):
            raise bad_data(
                path,
                f"a vector {both[0]} and a matrix with a column of this name",
                expected="one array for each column",
                remedy="rename one of them where the file is saved, or save only one",
                column=both[0],
            )
        columns |= own
    if header or (path.endswith(".npy") and not named and len(arrays) == 1 < len(columns)):
        columns = _with_header(path, columns, header)
    if not _are_a_table(kept):
        found = ", ".join(f"{name} ({_size(x)})" for name, x in kept.items()) or "no numbers"
        remedy = "name those of the log, such as `--map 't=time,q*=pos'`"
        raise bad_data(path, found, expected="arrays of one length", remedy=remedy)
    batch = pa.RecordBatch.from_arrays([doubles(x) for x in columns.values()], list(columns))
    table = Table(path, batch.schema, Metadata(), iter([batch]))
    singles = [f"{name} = {x.item():.6g}" for name, x in every.items() if _is_single(x)]
    return table, [name for name in arrays if name not in kept], singles


def _is_single(array: np.ndarray[Any, Any]) -> bool:
    return array.size == 1 and array.dtype.kind in "fiu"


def _with_header(path: str, columns: dict[str, Any], header: Sequence[str]) -> dict[str, Any]:
    """The columns of a matrix, called by the names of the header."""
    if not header:
        raise without_names(path, len(columns))
    if len(header) != len(columns):
        raise UsageFault(f"--header: {len(header)} names for {len(columns)} columns of {path}")
    return dict(zip(header, columns.values(), strict=True))


def _numeric(array: Any) -> bool:
    return array.dtype.kind in "fiub" and array.ndim <= 2


def _are_a_table(arrays: dict[str, Any]) -> bool:
    """Whether all are numbers, and of one length."""
    lengths = {max(array.shape) for array in arrays.values()}
    return len(lengths) == 1 and all(map(_numeric, arrays.values()))


def _size(array: Any) -> str:
    """`1000 x 6`, or `1000` of a vector."""
    return " x ".join(str(n) for n in sorted(array.shape, reverse=True) if n > 1)


def _read(path: str) -> dict[str, Any]:
    try:
        if path.endswith(".npy"):
            return _npy(path)
        return _npz(path) if path.endswith(".npz") else _mat(path)
    except (MemoryError, ScaridError):
        raise
    except Exception as error:  # damage shows in whatever a reader does with it
        reason = " ".join(str(error).split()) or type(error).__name__
        raise BadData(
            f"{path}: not a readable {Path(path).suffix} file ({reason}); save it again"
            f"{' with save -v7' if path.endswith('.mat') else ''}"
        ) from None


def require_moderate_archive(path: str) -> None:
    """Refuse an .npz file whose arrays would take far too much memory, which they do twice."""
    import zipfile

    with zipfile.ZipFile(path) as archive:
        require_moderate(path, COPIES * sum(entry.file_size for entry in archive.infolist()))
        _require_all(path, len(archive.infolist()))


def _npz(path: str) -> dict[str, Any]:
    require_moderate_archive(path)
    with Path(path).open("rb") as file, np.load(file, allow_pickle=False) as arrays:
        found = {name: arrays[name] for name in arrays.files}
    other = next((name for name, x in found.items() if not isinstance(x, np.ndarray)), None)
    if other is not None:
        raise ValueError(f"it contains {printable(other)}, which is not an array")
    return found


def _npy(path: str) -> dict[str, Any]:
    """The fields of the array, or the array under the name of the file."""
    array = np.load(path, allow_pickle=False, mmap_mode="r")
    require_moderate(path, COPIES * array.nbytes)
    if array.dtype.names:
        return {name: np.ascontiguousarray(array[name]) for name in array.dtype.names}
    return {Path(path).stem: np.array(array)}


def _require_all(path: str, found: int) -> None:
    """Refuse an archive whose end states more arrays: a bit can hide one from zipfile."""
    with Path(path).open("rb") as file:
        file.seek(-END_OF_ZIP.size, SEEK_END)
        mark, stated = END_OF_ZIP.unpack(file.read())
    if mark == b"PK\5\6" and stated not in (found, MANY):
        raise ValueError(f"it has {found} of {stated} arrays")


def _mat(path: str) -> dict[str, Any]:
    """The arrays of a .mat file, read by another process: damaged ones crash scipy's reader."""
    import io
    import subprocess
    import sys

    program = [sys.executable, "-m", "scarid_cli.io.matfile", path, str(max_batch())]
    done = subprocess.run(program, capture_output=True, check=False)
    if done.returncode == TOO_LARGE:
        require_moderate(path, int(done.stdout))
    if done.returncode:
        lines = done.stderr.decode(errors="replace").splitlines()
        raise ValueError(lines[-1] if lines else "its reader crashed")
    with np.load(io.BytesIO(done.stdout), allow_pickle=False) as arrays:
        return {name: arrays[name] for name in arrays.files}


def _kind(array: Any) -> str:
    text = array.dtype.kind in "US"  # by which cells and objects are described, too
    return "text, cells or objects" if text else f"values of type {array.dtype}"


def _columns(path: str, name: str, array: Any) -> dict[str, Any]:
    """The columns of an array by name."""
    if not _numeric(array):
        raise bad_data(
            path,
            f"{array.ndim} dimensions" if array.ndim > 2 else _kind(array),
            expected="vectors or matrices of real numbers",
            remedy="save only the arrays of the log, or name those with --map",
            column=name,
        )
    if array.dtype.kind in "iu" and np.any(array.astype(np.float64).astype(array.dtype) != array):
        raise bad_data(
            path,
            "whole numbers beyond 2^53",
            expected="numbers that a double can hold",
            remedy="subtract an offset before saving them",
            column=name,
        )
    flat = array.reshape(len(array), -1)
    if flat.shape[0] < flat.shape[1]:
        flat = flat.T
    return dict(zip(_names(name, array)[-flat.shape[1] :], flat.T, strict=True))


def _names(name: str, array: Any) -> list[str]:
    """The name of a vector; of a matrix, its name and one for each column, or longer row."""
    width = min(array.shape) if array.ndim > 1 else 1
    return [name, *(f"{name}{i}" for i in range(1, width + 1))] if width > 1 else [name]
