"""`python -m scarid_cli.cli.manual FOLDER` writes the man pages into a folder."""

from __future__ import annotations

import os
import sys
from datetime import UTC, datetime
from pathlib import Path

from scarid_cli.cli.manual import roff
from scarid_cli.cli.manual.pages import pages


def write(folder: Path) -> list[Path]:
    """One file for each page; dated by SOURCE_DATE_EPOCH [s] if that is set, else today."""
    stated = os.environ.get("SOURCE_DATE_EPOCH")
    day = (datetime.fromtimestamp(int(stated), UTC) if stated else datetime.now(UTC)).date()
    folder.mkdir(parents=True, exist_ok=True)
    found = []
    for page in pages():
        found.append(folder / f"{page.name}.1")
        found[-1].write_text(roff.rendered(page, day), "utf-8")
    return found


if __name__ == "__main__":
    write(Path(sys.argv[1]))
