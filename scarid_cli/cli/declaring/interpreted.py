"""Whether the kernels run compiled: interpreted, they give the same bits, but slowly."""

from __future__ import annotations

import os
from importlib.machinery import EXTENSION_SUFFIXES

import scarid_cli

PACKAGE = os.path.dirname(scarid_cli.__file__)  # noqa: PTH120 (pathlib takes a while to import)
FOLDER = os.path.join(PACKAGE, "kernels")  # noqa: PTH118


def interpreted() -> list[str]:
    """The names of the kernels that are not compiled for this Python."""
    files = os.listdir(FOLDER)  # noqa: PTH208 (likewise)
    compiled = {
        file.removesuffix(suffix)
        for suffix in EXTENSION_SUFFIXES
        for file in files
        if file.endswith(suffix)
    }
    sources = {file.removesuffix(".py") for file in files if file.endswith(".py")}
    return sorted(name for name in sources - compiled if not name.startswith("_"))


def notice() -> str:
    """What a run says at its start if kernels are interpreted, else nothing."""
    names = interpreted()
    if not names:
        return ""
    which = "the kernels are" if len(names) > 1 else f"the kernel {names[0]} is"
    return (
        f"this run is slow: {which} not compiled, because there was no C compiler when scarid was "
        "installed; install gcc or clang, then scarid again (docs/speed.md)"
    )
