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
from typing import Any

import numpy as np

DOUBLE = 8  # bytes
LIBRARIES = 1 << 28  # bytes of memory
COPIES = 2  # of the arrays of an archive that are in memory: as they are, and as columns
TOO_LARGE = 3  # exit status


def main(path: str, most: int) -> int:
    """Write the arrays. Those of objects and text go as text, which the reader refuses by name."""
    from scipy.io import loadmat, whosmat

    warnings.simplefilter("ignore")
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
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
