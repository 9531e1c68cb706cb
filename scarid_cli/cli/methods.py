"""From `--settings FILE`, `--preset` and `--set NAME=VALUE[,VALUE...]` to one method per joint."""

from __future__ import annotations

from typing import Any

from scarid_cli.algorithms.choices.registry import Registry
from scarid_cli.algorithms.choices.settings import names_of
from scarid_cli.cli import pairs
from scarid_cli.cli.job import per_joint
from scarid_cli.cli.settings import PerJoint, SavedSettings
from scarid_cli.errors import UsageFault


def configured(
    registry: Registry,
    name: str,
    joints: int,
    *,
    given: tuple[str, ...],
    preset: str | None,
    saved: SavedSettings | None,
) -> list[Any]:
    """One instance of the method for each joint.

    The preset is overridden by the saved settings, and these by the settings given with --set.
    """
    if name not in registry.names:
        raise UsageFault(f"--settings: no method {name!r}; there are {', '.join(registry.names)}")
    method = registry.load(name)
    known = names_of(method)
    values: PerJoint = {key: [x] * joints for key, x in _preset(method, name, preset).items()}
    if saved:
        for key in saved.names(name):
            pairs.require_known(known, key, name, f"--settings: {key}: ")
            values[key] = saved.values(name, key, joints)
    for key, row in pairs.settings(given, known, name):
        values[key] = per_joint(row, joints, f"--set {key}")
    return [method(**{key: row[joint] for key, row in values.items()}) for joint in range(joints)]


def _preset(method: Any, name: str, preset: str | None) -> dict[str, float]:
    if preset is None:
        return {}
    if preset not in method.PRESETS:
        choice = ", ".join(method.PRESETS) or "none"
        raise UsageFault(f"--preset: {name} has no preset {preset!r}; it has {choice}")
    settings: dict[str, float] = method.PRESETS[preset]
    return settings
