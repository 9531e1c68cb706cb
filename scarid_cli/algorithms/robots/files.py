"""The text of a file that a user names: a regular file, and not a huge one."""

from __future__ import annotations

import os
import re
import stat
from collections.abc import Callable
from functools import cache, wraps
from pathlib import Path
from typing import Any, TypeVar

from scarid_cli.errors import OutputFailure, UsageFault

T = TypeVar("T")
LARGEST = 16_000_000  # bytes: the largest public URDFs have half a megabyte
LAST: dict[str, tuple[object, ...]] = {}  # what was last seen at each path: _stamp
DEEPEST = 32  # parts of a dotted TOML key: a table for each takes time and memory that grow faster
PART = r"""["'A-Za-z_][\w"'-]*"""
KEY = re.compile(rf"{PART}(?:\s*\.\s*{PART}){{{DEEPEST},}}")


def text_of(path: str | Path) -> str:
    """The text; UsageFault for a device, a pipe or a folder, and for what is far too large."""
    try:
        found = Path(path).stat()
        if not stat.S_ISREG(found.st_mode):
            raise UsageFault(f"{path}: not a regular file; give one with the description")
        if found.st_size > LARGEST:
            raise UsageFault(
                f"{path}: {found.st_size / 1e6:,.0f} MB are no description of a robot; give a file "
                f"of at most {LARGEST / 1e6:.0f} MB"
            )
        return Path(path).read_text("utf-8")
    except FileNotFoundError:
        raise UsageFault(f"{path}: no such file") from None
    except OSError as error:
        raise OutputFailure(f"{path}: {error.strerror}") from None


def require_shallow(text: str) -> None:
    """Refuse a TOML key of very many parts."""
    if found := KEY.search(text):
        line = text.count("\n", 0, found.start()) + 1
        raise ValueError(f"line {line}: a key of more than {DEEPEST} parts")


def of_file(function: Callable[..., T]) -> Callable[..., T]:
    """Keep what the function makes of a file (its first argument) and of its other arguments.

    A file that has changed, or another one of that name after a change of folder, is read anew.
    One that has gone since is what it was: the robot is in use.
    """

    @cache
    def kept(_stamp: tuple[object, ...], *arguments: Any) -> T:
        return function(*arguments)

    @wraps(function)
    def found(path: str, *arguments: Any) -> T:
        return kept(_stamp(path), path, *arguments)

    return found


def _stamp(path: str) -> tuple[object, ...]:
    place = os.path.abspath(path)  # noqa: PTH100 (asked for at each use)
    try:
        status = os.stat(path)  # noqa: PTH116 (likewise)
    except OSError:
        return LAST.get(place, (place,))
    LAST[place] = status.st_dev, status.st_ino, status.st_size, status.st_mtime_ns
    return LAST[place]
