"""What a run reports beside its result, kept until there is one: a refusal stands alone."""

from __future__ import annotations

from collections.abc import Callable

from scarid_cli.cli.running.terminal import styled
from scarid_cli.printable import printable


class Remarks:
    """Lines for the user, which `say` takes."""

    def __init__(self, say: Callable[[str], None]) -> None:
        self._say = say
        self._kept: list[tuple[str, str, str]] = []

    def keep(self, message: str, verdict: str, command: str) -> None:
        """A line, which begins in the colour of the `verdict`, if it begins with one.

        A `command` line to copy stands behind it.
        """
        self._kept.append((message, verdict, command))

    def tell(self) -> None:
        """Report what was kept, now that the run has ended well."""
        for message, verdict, command in self._kept:
            start = styled(verdict, verdict, 2) if verdict else ""
            end = f"\n{printable(command)}" if command else ""
            self._say(f"{start}{printable(message.removeprefix(verdict))}{end}")
