"""From `--settings FILE`, `--preset` and `--set NAME=VALUE[,VALUE...]` to one method per joint."""

from __future__ import annotations

from typing import Any

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.algorithms.choices.settings import names_of
from scarid_cli.cli.declaring import pairs
from scarid_cli.cli.running.job import per_joint
from scarid_cli.cli.running.settings import PerJoint, read
from scarid_cli.errors import UsageFault


def configured(
    joints: int,
    *,
    method: str | None,
    given: tuple[str, ...],
    preset: str | None,
    settings: str | None,
    option: str | None = None,
) -> list[Any]:
    """One instance of the method for each joint: by default the best of the saved settings.

    The preset is overridden by the saved settings, and these by the settings given with --set.
    Errors name these options, or the one `option` that has all of it.
    """
    saved = read(settings) if settings else None
    name = (saved.best if saved else "kalman") if method is None else method
    if name not in DIFFERENTIATORS.names:
        choice = ", ".join(DIFFERENTIATORS.names)
        raise UsageFault(f"{option or '--settings'}: no method {name!r}; there are {choice}")
    chosen = DIFFERENTIATORS.load(name)
    known = names_of(chosen)
    base = _preset(chosen, name, preset, option or "--preset")
    values: PerJoint = {key: [x] * joints for key, x in base.items()}
    if saved:
        for key in saved.names(name):
            pairs.require_known(known, key, name, f"--settings: {key}: ")
            values[key] = saved.values(name, key, joints)
    for key, row in pairs.settings(given, known, name, option or "--set"):
        values[key] = per_joint(row, joints, f"{option or '--set'} {key}")
    return [chosen(**{key: row[joint] for key, row in values.items()}) for joint in range(joints)]


def _preset(method: Any, name: str, preset: str | None, option: str) -> dict[str, float]:
    if preset is None:
        return {}
    if preset not in method.PRESETS:
        choice = ", ".join(method.PRESETS) or "none"
        raise UsageFault(f"{option}: {name} has no preset {preset!r}; it has {choice}")
    settings: dict[str, float] = method.PRESETS[preset]
    return settings
