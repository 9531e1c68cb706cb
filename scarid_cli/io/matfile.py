"""`python -m scarid_cli.io.matfile FILE`: the arrays of a .mat file, as .npz on standard output.

It is a process of its own, because damaged files crash the reader of scipy. The last line on
standard error says why a file cannot be read.
"""

from __future__ import annotations

import io
import resource
import sys
import warnings
from typing import Any

import numpy as np

MEMORY = 8 << 30  # bytes of address space, most of it of the libraries


def main(path: str) -> None:
    """Write the arrays. Those of objects and text go as text, which the reader refuses by name."""
    from scipy.io import loadmat

    warnings.simplefilter("ignore")
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    found = {name: x for name, x in loadmat(path).items() if not name.startswith("__")}
    arrays: dict[str, Any] = {name: _plain(np.asarray(x)) for name, x in found.items()}
    out = io.BytesIO()
    np.savez(out, **arrays)
    sys.stdout.buffer.write(out.getvalue())


def _plain(array: Any) -> Any:
    """Cells and structures as their description in words; other arrays as they are."""
    if array.dtype.hasobject:
        return np.full(array.shape, "cell or structure")
    return array


if __name__ == "__main__":
    main(sys.argv[1])
