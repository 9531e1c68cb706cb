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
    arrays: dict[str, Any] = {name: _plain(np.asarray(x)) for name, x in found.items()}
    np.savez(sys.stdout.buffer, **arrays)
    return 0


def _plain(array: Any) -> Any:
    """Cells and structures as their description in words; other arrays as they are."""
    if array.dtype.hasobject:
        return np.full(array.shape, "cell or structure")
    return array


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], int(sys.argv[2])))
