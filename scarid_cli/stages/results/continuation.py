"""Save the checkpoint of an estimation, and restore it to continue with another log."""

from __future__ import annotations

import io
import json
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any, cast, get_type_hints

import numpy as np

from scarid_cli.algorithms.estimators.adaptive import Bank
from scarid_cli.algorithms.estimators.ekf import FilterState
from scarid_cli.algorithms.estimators.rls import WeightedInformation
from scarid_cli.algorithms.regression.counting import LeftOut, Speeds
from scarid_cli.algorithms.regression.estimation import BaseEstimator
from scarid_cli.algorithms.regression.information import Information
from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.uncertainty.blocks import Blocks
from scarid_cli.algorithms.uncertainty.checkpoint import Checkpoint
from scarid_cli.algorithms.uncertainty.subsample import Subsample
from scarid_cli.errors import BadData, UsageFault
from scarid_cli.io.foreign import require_moderate_archive
from scarid_cli.stages.results.soundness import require_state

KNOWN = {
    kind.__name__: kind
    for kind in (
        Bank,
        Blocks,
        Information,
        Checkpoint,
        FilterState,
        LeftOut,
        Rows,
        Speeds,
        Subsample,
        WeightedInformation,
    )
}


def saved(checkpoint: Checkpoint, settings: dict[str, Any]) -> bytes:
    """The content of an .npz file with the checkpoint and the settings of the estimation.

    It holds the arrays of the checkpoint, and a JSON document that describes its structure.
    """
    arrays: dict[str, Any] = {}
    tree = json.dumps({"settings": settings, "checkpoint": _packed(checkpoint, arrays)})
    out = io.BytesIO()
    np.savez(out, tree=np.array(tree), **arrays)
    return out.getvalue()


def restored(
    path: str, settings: dict[str, Any], estimator: BaseEstimator, robot: Robot
) -> Checkpoint:
    """The checkpoint in a file, which must be that of an estimation with the same settings.

    What is no state of this estimator for this robot is BadData.
    """
    try:
        require_moderate_archive(path)
        with Path(path).open("rb") as file, np.load(file, allow_pickle=False) as archive:
            document = json.loads(str(archive["tree"]))
            checkpoint = _unpacked(document["checkpoint"], archive)
            before = dict(document["settings"])
    except FileNotFoundError:
        raise UsageFault(f"{path}: no such file; make one with `scarid identify --save`") from None
    except Exception:  # damage shows in whatever a reader does with it
        raise _no_state(path) from None
    for key, value in settings.items():
        if before.get(key) != value:
            raise UsageFault(
                f"{path}: the estimation was saved with {key} {before.get(key)}, not {value}; "
                "continue it with the same"
            )
    try:
        state = get_type_hints(type(estimator).init)["return"]
        require_state(checkpoint, state, len(robot.joints), len(robot.parameters))
    except (AttributeError, TypeError, ValueError):
        raise _no_state(path) from None
    return cast("Checkpoint", checkpoint)


def _no_state(path: str) -> BadData:
    return BadData(
        f"{path}: this is not a saved estimation; make one with `scarid identify --save`"
    )


def _packed(value: Any, arrays: dict[str, Any]) -> Any:
    """The value as JSON, in which arrays are replaced by their names in `arrays`."""
    if isinstance(value, np.ndarray):
        name = f"a{len(arrays)}"
        arrays[name] = value
        return {"array": name}
    if is_dataclass(value):
        parts = {f.name: _packed(getattr(value, f.name), arrays) for f in fields(value)}
        return {"kind": type(value).__name__, "fields": parts}
    if isinstance(value, tuple | list):
        return {"items": [_packed(item, arrays) for item in value]}
    if isinstance(value, dict):
        return {"map": {key: _packed(item, arrays) for key, item in value.items()}}
    return {"value": value}


def _unpacked(tree: Any, archive: Any) -> Any:
    """The value that `_packed` turned into this JSON."""
    if "array" in tree:
        return archive[tree["array"]]
    if "kind" in tree:
        parts = {name: _unpacked(part, archive) for name, part in tree["fields"].items()}
        return KNOWN[tree["kind"]](**parts)
    if "items" in tree:
        return tuple(_unpacked(item, archive) for item in tree["items"])
    if "map" in tree:
        return {key: _unpacked(item, archive) for key, item in tree["map"].items()}
    return tree["value"]
