"""What a run reports beside its result, kept until there is one: a refusal stands alone."""

from __future__ import annotations

from collections.abc import Callable

from scarid_cli.cli.terminal import styled
from scarid_cli.printable import printable


class Remarks:
    """Lines for the user, which `say` takes."""

    def __init__(self, say: Callable[[str], None]) -> None:
        self._say = say
        self._kept: list[tuple[str, str]] = []

    def keep(self, message: str, verdict: str) -> None:
        """A line, which begins in the colour of the `verdict`, if it begins with one."""
        self._kept.append((message, verdict))

    def tell(self) -> None:
        """Report what was kept, now that the run has ended well."""
        for message, verdict in self._kept:
            start = styled(verdict, verdict, 2) if verdict else ""
            self._say(f"{start}{printable(message.removeprefix(verdict))}")
