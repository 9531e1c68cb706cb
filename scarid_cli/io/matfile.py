"""`python -m scarid_cli.io.matfile FILE BYTES`: the arrays of a .mat file, as .npz.

They go to standard output, unless they would take more BYTES of memory: then that number does.

It is a process of its own, because damaged files crash the reader of scipy. The last line on
standard error says why a file cannot be read.
"""

from __future__ import annotations

import math
import resource
import sys
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

DOUBLE = 8  # bytes
HDF5 = b"\x89HDF\r\n\x1a\n"
LIBRARIES = 1 << 28  # bytes of memory
COPIES = 2  # of the arrays of an archive that are in memory: as they are, and as columns
TOO_LARGE = 3  # exit status


def main(path: str, most: int) -> int:
    """Write the arrays. Those of objects and text go as text, which the reader refuses by name."""
    warnings.simplefilter("ignore")
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    if _is_hdf5(path):
        return _write_hdf5(path, most)
    from scipy.io import loadmat, whosmat

    stated = sum(DOUBLE * math.prod(shape) for _, shape, _ in whosmat(path))
    if COPIES * stated > most:
        sys.stdout.write(str(COPIES * stated))
        return TOO_LARGE
    # What the file states may be untrue: the libraries take the rest.
    resource.setrlimit(resource.RLIMIT_DATA, (most + LIBRARIES, most + LIBRARIES))
    found = {name: x for name, x in loadmat(path).items() if not name.startswith("__")}
    arrays = [pair for name, x in found.items() for pair in _arrays(name, x)]
    np.savez(sys.stdout.buffer, **dict(arrays))
    return 0


def _is_hdf5(path: str) -> bool:
    """Whether it is an HDF5 file, as MATLAB's version 7.3 is behind 512 bytes of its own."""
    with Path(path).open("rb") as file:
        start = file.read(520)
    return HDF5 in (start[:8], start[512:520])


def _write_hdf5(path: str, most: int) -> int:
    """Write the numbers of an HDF5 file, by the path of groups, as `log.q`."""
    try:
        import h5py
    except ImportError:
        raise SystemExit("it is HDF5, which needs h5py: pip install 'scarid[hdf5]'") from None
    found: dict[str, Any] = {}

    def take(name: str, item: Any) -> None:
        inside = name.startswith("#") or not isinstance(item, h5py.Dataset)
        if not inside and item.dtype.kind in "fiub" and item.attrs.get("MATLAB_class") != b"char":
            found[name.replace("/", ".")] = item

    with h5py.File(path, "r") as file:
        matlab = any("MATLAB_class" in item.attrs for item in file.values())
        file.visititems(take)
        resource.setrlimit(resource.RLIMIT_DATA, (most + LIBRARIES, most + LIBRARIES))
        stated = sum(DOUBLE * math.prod(item.shape) for item in found.values())
        if COPIES * stated > most:
            sys.stdout.write(str(COPIES * stated))
            return TOO_LARGE
        arrays = {name: item[()].T if matlab else item[()] for name, item in found.items()}
    np.savez(sys.stdout.buffer, **arrays)
    return 0


def _arrays(name: str, value: Any) -> Iterator[tuple[str, Any]]:
    """The arrays of a variable by name; a structure has one for each field, as `log.q`.

    Structures in a matrix are numbered. Of their fields only numbers are kept. Cells and objects
    are described in words.
    """
    if type(value) is np.ndarray and value.dtype.names:
        for i, one in enumerate(value.ravel(), start=1):
            number = str(i) if value.size > 1 else ""
            for field in value.dtype.names:
                inside = _arrays(f"{name}{number}.{field}", one[field])
                yield from ((n, x) for n, x in inside if x.dtype.kind in "fiubc")
    elif np.asarray(value).dtype.hasobject:
        yield name, np.full(np.shape(value), "cell or object")
    else:
        yield name, np.asarray(value)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], int(sys.argv[2])))
