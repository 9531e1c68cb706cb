"""A table that a report reads, with what the other tables of the report say of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.io.table import Table
from scarid_cli.reporting.naming import Name


@dataclass(frozen=True)
class Source:
    """The table, its name, the robot that it states, and those that any table states.

    `with_common`: what the table has as the truth is the common motion of its log.
    """

    table: Table
    name: Name
    robot: Robot | None
    robots: Sequence[Robot]
    with_common: bool = False

    def robot_with(self, names: Sequence[str]) -> Robot | None:
        """The robot with these parameters: the table's own, else any (a CSV states none)."""
        candidates = [self.robot] if self.robot else self.robots
        return next((robot for robot in candidates if robot.names == list(names)), None)
