"""From `--settings FILE`, `--preset` and `--set NAME=VALUE[,VALUE...]` to one method per joint."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from scarid_cli.algorithms.choices.registry import Registry
from scarid_cli.cli.job import per_joint
from scarid_cli.cli.pairs import pair, require_known
from scarid_cli.cli.settings import Settings
from scarid_cli.errors import UsageFault


def configured(
    registry: Registry,
    name: str,
    joints: int,
    settings: tuple[str, ...],
    preset: str | None,
    saved: Settings,
) -> list[Any]:
    """One instance of the method for each joint; what is set by hand comes last."""
    method = _method(registry, name)
    known = [field.name for field in fields(method)]
    values = {key: [value] * joints for key, value in _preset(method, name, preset).items()}
    for key, numbers in saved.get(name, {}).items():
        require_known(known, key, name, f"--settings: {key}: ")
        values[key] = per_joint(numbers, joints, f"--settings: {name}, {key}")
    for text in settings:
        key, value = pair(text, "--set")
        require_known(known, key, name, f"--set {text}: ")
        values[key] = per_joint(_numbers(text, value), joints, f"--set {key}")
    return [method(**{key: row[joint] for key, row in values.items()}) for joint in range(joints)]


def _method(registry: Registry, name: str) -> Any:
    if name not in registry.names:
        raise UsageFault(f"--settings: no method {name!r}; there are {', '.join(registry.names)}")
    return registry.load(name)


def _numbers(text: str, value: str) -> list[float]:
    try:
        return [float(part) for part in value.split(",")]
    except ValueError:
        raise UsageFault(f"--set {text}: {value!r} is not a number") from None


def _preset(method: Any, name: str, preset: str | None) -> dict[str, float]:
    if preset is None:
        return {}
    if preset not in method.PRESETS:
        choice = ", ".join(method.PRESETS) or "none"
        raise UsageFault(f"--preset: {name} has no preset {preset!r}; it has {choice}")
    settings: dict[str, float] = method.PRESETS[preset]
    return settings
