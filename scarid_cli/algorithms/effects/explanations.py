"""Which alternative alone explains nearly all that the torques are beyond the model.

On a real robot several are often significant, because each makes up for something else. Where one
leaves next to nothing to explain, it is the likely cause.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from scarid_cli.algorithms.beyond.catalogue import PHENOMENA, kind_of
from scarid_cli.algorithms.beyond.mounting import Tilt
from scarid_cli.algorithms.beyond.torques import Ripple
from scarid_cli.algorithms.effects.effects import CERTAIN, Effect, Trial, clear, level_among
from scarid_cli.arrays import Array

# The names of alternatives for the torques, with the joints (from 0) to whose torques they belong.
Torques = frozenset[tuple[str, int]]
RARE = 0.001  # probability of fitting what is not there
LEFT = 0.25  # times as clear as the alternative itself: what it may leave unexplained


@dataclass(frozen=True)
class Explanation:
    """An alternative that explains nearly all that the torques are beyond the model.

    It is as clear as its `clearness`; what is left is not clearer than `rest`. To be fitted, it
    must be larger than so many errors as its `threshold` says, and each part larger than `each`.
    `cycles` (ripples, joints) are the periods per rad or m that ripples have.
    """

    torques: Torques
    clearness: float
    threshold: float
    cycles: Array
    each: float = 0.0

    @property
    def kindred(self) -> set[str]:
        """What other joints may have of the same, for which their intervals are wider."""
        return {other for name, _ in self.torques for other in PHENOMENA[name].WIDER}

    @property
    def rest(self) -> float:
        return max(1.0, LEFT * self.clearness)


def explanations(trial: Trial, effects: Sequence[Effect]) -> tuple[Explanation, ...]:
    """The alternatives each of which explains the torques, the clearest one first.

    `effects` are those of all alternatives.
    """
    level = level_among(effects)
    found = []
    for effect in clear(effects):
        if PHENOMENA[effect.name].FITTED:
            torques = _torques(trial, [effect], level)
            least = effect.threshold(RARE / CERTAIN * level)
            one = Explanation(torques, effect.clearness(level), least, trial.ripples.cycles)
            found.append(_completed(trial, one))
    return tuple(sorted(filter(None, found), key=lambda x: -x.clearness))


def _completed(trial: Trial, one: Explanation) -> Explanation | None:
    """The same, with others of its kind that are clear; None if it does not explain the torques.

    A ripple goes with any of them: none is like it, so that neither makes up for the other.
    """
    kinds = {Ripple.NAME, *(kind_of(name) for name, _ in one.torques)}
    while (left := _beside(trial, one.torques)) is not None:
        kindred = [effect for effect in clear(left) if kind_of(effect.name) in kinds]
        more = _torques(trial, kindred, level_among(left))
        if more <= one.torques:
            return None if clear(left, one.rest) else one
        one = replace(one, torques=one.torques | more)
    return None


def _beside(trial: Trial, torques: Torques) -> list[Effect] | None:
    """The effects beside these torques; None if the rows do not determine them."""
    products, places = trial.beyond
    joints = trial.rows.y.shape[1]
    columns = [k for name, j in sorted(torques) for k in places[name][j::joints]]
    given = products.independent(columns)
    wider = products.solved(given)
    return trial.among_torques(wider, given) if wider else None


def _leaning(trial: Trial) -> list[int]:
    """The columns of a tilted base that the rows determine."""
    products, places = trial.beyond
    there = products.independent(places[Tilt.NAME])
    return [k for k, column in enumerate(places[Tilt.NAME]) if column in there]


def _torques(trial: Trial, effects: Sequence[Effect], level: float) -> Torques:
    """The names of these effects, with the joints where they are significant.

    A tilt has columns in their place, of which it takes all that there are.
    """
    joints = trial.rows.y.shape[1]
    return frozenset(
        (x.name, j)
        for x in effects
        for j in (_leaning(trial) if x.name == Tilt.NAME else x.joints(level, joints))
    )
