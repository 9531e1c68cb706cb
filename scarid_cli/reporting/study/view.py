"""What all chapters of a page share: the order of the methods and the colour of each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from scarid_cli.reporting.kinds import Result
from scarid_cli.reporting.study.blocks import Key
from scarid_cli.reporting.study.ranking import Ranking


@dataclass(frozen=True)
class View:
    """The ranking, if methods can be ranked, and the number of each label's colour."""

    FEW: ClassVar[int] = 3  # methods that figures show at first

    ranking: Ranking | None
    colours: dict[str, int]

    def style(self, label: str) -> str:
        """The class of the colour of a method."""
        return f"m{self.colours[label]}"

    def place(self, result: Result) -> int:
        """The place of a result's method, the best being 0; unranked ones come last."""
        places = self.ranking.places() if self.ranking else {}
        exact = [s.name for s in self.ranking.standings] if self.ranking else []
        own = f"{result.name.label}, {result.name.experiment}"
        if own in exact:
            return exact.index(own)
        return places.get(result.name.label, len(exact) + self.colours[result.name.label])

    def keys(self, labels: Sequence[str]) -> tuple[Key, ...]:
        """The legend of these methods, the best first; all but a few are off."""
        return tuple(
            Key(label, self.style(label), off=i >= self.FEW)
            for i, label in enumerate(dict.fromkeys(labels))
        )
