"""Which alternatives alone explain all that the torques are beyond the model.

On a real robot several are often significant, because each makes up for something else. Where one
leaves nothing to explain, it is the likely cause.
"""

from __future__ import annotations

from collections.abc import Sequence

from scarid_cli.algorithms.statistics.alternatives import DECAYED, OFFSET, SHAPES
from scarid_cli.algorithms.statistics.effects import CERTAIN, Effect, Trial, clear

# The names of alternatives for the torques, with the joints (from 0) to whose torques they belong.
Explanation = frozenset[tuple[str, int]]
FITTED = SHAPES.keys() - {OFFSET}  # which offsets.py looks for


def explanations(trial: Trial, effects: Sequence[Effect]) -> tuple[Explanation, ...]:
    """The alternatives each of which alone explains the torques, the clearest one first.

    `effects` are those of all alternatives.
    """
    level = CERTAIN / max(1, len(effects))
    possible = [effect for effect in clear(effects) if effect.name in FITTED]
    possible.sort(key=lambda effect: -effect.largest / effect.threshold(level))
    found = (_completed(trial, _torques(trial, [effect], level)) for effect in possible)
    return tuple(explanation for explanation in found if explanation)


def _completed(trial: Trial, torques: Explanation) -> Explanation | None:
    """These torques, and others of their kind; None if anything else is significant beside them."""
    kinds = {name for name, _ in torques}
    if kinds & DECAYED.keys():  # one curve of friction
        kinds |= DECAYED.keys()
    while left := _left(trial, torques):
        level = CERTAIN / len(trial.beyond[1])
        more = _torques(trial, [effect for effect in left if effect.name in kinds], level)
        if more <= torques:
            return None
        torques |= more
    return torques if left is not None else None


def _left(trial: Trial, torques: Explanation) -> list[Effect] | None:
    """What is significant beside these torques; None if the rows do not determine them."""
    products, places = trial.beyond
    joints = trial.rows.y.shape[1]
    columns = [k for name, j in sorted(torques) for k in places[name][j::joints]]
    given = products.independent(columns)
    wider = products.solved(given)
    return clear(trial.beside(products, places, wider, wider, given)) if wider else None


def _torques(trial: Trial, effects: Sequence[Effect], level: float) -> Explanation:
    """The names of these effects, with the joints where they are significant."""
    joints = trial.rows.y.shape[1]
    return frozenset((x.name, j) for x in effects for j in x.joints(level, joints))
