"""The robot that a table states, as far as it may be opened.

A table comes from anywhere, and must not choose which files are read. The name of a robot of the
package is taken from it; a file only if the history of the table has the digest of this very file,
which also tells a description that has changed since.
"""

from __future__ import annotations

import os
from pathlib import Path

from scarid_cli.errors import UsageFault
from scarid_cli.io.bytesource import ByteSource
from scarid_cli.io.table import Table

DESCRIPTIONS = (".toml", ".urdf")  # extensions of descriptions in files


def in_file(robot: str) -> bool:
    """Whether a robot is stated by the path of its description, rather than by a name."""
    return robot.endswith(DESCRIPTIONS)


def stated_robot(table: Table) -> str | None:
    """The robot that the metadata state, or None.

    A file that is not the one with which the table was made is a UsageFault, unless the user names
    it in SCARID_ROBOT.
    """
    robot = table.meta.robot
    if not robot or not in_file(robot) or robot == os.environ.get("SCARID_ROBOT"):
        return robot
    digests = [entry["inputs"].get(robot) for entry in table.meta.history]
    if any(digests) and Path(robot).is_file() and _digest(robot) in digests:
        return robot
    raise UsageFault(
        f"{table.name}: its robot is stated as {robot}, which is not here as it was when the table "
        "was made; state the robot with --robot"
    )


def _digest(path: str) -> str | None:
    source = ByteSource.open(path)
    try:
        return source.sha256()
    finally:
        source.close()
