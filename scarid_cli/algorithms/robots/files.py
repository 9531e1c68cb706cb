"""The text of a file that a user names: a regular file, and not a huge one."""

from __future__ import annotations

import re
import stat
from pathlib import Path

from scarid_cli.errors import OutputFailure, UsageFault

LARGEST = 16_000_000  # bytes: the largest public URDFs have half a megabyte
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
