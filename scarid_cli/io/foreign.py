"""Foreign files: CSV in other notations, NumPy's .npz and MATLAB's .mat files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa

from scarid_cli.errors import BadData, bad_data
from scarid_cli.io.bytesource import ByteSource, Wrapped
from scarid_cli.io.notation import SPACE, Notation
from scarid_cli.io.table import Metadata, Table, doubles

ARCHIVES = (".npz", ".mat")
COMMENTS = b"#%"  # that begin a line before the header


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
        source.drop_comments(COMMENTS)
        if notation.header:
            self._ahead = ",".join(notation.header).encode() + b"\n"

    def _fetch(self, size: int) -> bytes:
        data = self.source.read_some(size)
        if not self._space:
            return data.translate(self._table)
        ended = not data
        while not ended and b"\n" not in data:
            more = self.source.read_some(size)
            data, ended = data + more, not more
        block = self._rest + data
        end = len(block) if ended else block.rfind(b"\n") + 1
        self._rest = block[end:]
        lines = block[:end].translate(self._table).split(b"\n")
        return b"\n".join(b",".join(line.split()) for line in lines)


def read_archive(path: str) -> Table:
    """The arrays of an .npz or .mat file as columns; a matrix `q` becomes q1, q2, ..."""
    try:
        arrays = _arrays(path)
    except (OSError, ValueError, TypeError, NotImplementedError) as error:
        reason = " ".join(str(error).split())
        raise BadData(
            f"{path}: not a readable {Path(path).suffix} file ({reason}); save it again"
        ) from None
    columns: dict[str, Any] = {}
    for name, array in arrays.items():
        columns |= _columns(name, np.asarray(array))
    lengths = {len(column) for column in columns.values()}
    if not columns or len(lengths) > 1:
        found = ", ".join(f"{name} ({len(x)})" for name, x in columns.items()) or "no numbers"
        raise bad_data(
            path, found, expected="arrays of one length", remedy="save only those of the log"
        )
    batch = pa.RecordBatch.from_arrays([doubles(x) for x in columns.values()], list(columns))
    return Table(path, batch.schema, Metadata(), iter([batch]))


def _arrays(path: str) -> dict[str, Any]:
    if path.endswith(".npz"):
        with np.load(path, allow_pickle=False) as archive:
            return {name: archive[name] for name in archive.files}
    from scipy.io import loadmat
    from scipy.io.matlab import MatReadError

    try:
        found = loadmat(path)
    except MatReadError as error:
        raise ValueError(str(error)) from None
    return {name: array for name, array in found.items() if not name.startswith("__")}


def _columns(name: str, array: Any) -> dict[str, Any]:
    """One column for a vector; for a matrix one per column, or one per row if rows are longer."""
    if array.dtype.kind not in "fiub" or array.ndim > 2 or array.size < 2:
        return {}
    flat = array.reshape(len(array), -1) if array.ndim else array.reshape(1, 1)
    if flat.shape[0] < flat.shape[1]:
        flat = flat.T
    if flat.shape[1] == 1:
        return {name: flat[:, 0]}
    return {f"{name}{i}": column for i, column in enumerate(flat.T, start=1)}
