"""From `--set NAME=VALUE[,VALUE...]` and `--preset` to one configured method per joint."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from scarid_cli.cli.job import per_joint
from scarid_cli.errors import UsageFault


def configured(
    method: Any, name: str, joints: int, settings: tuple[str, ...], preset: str | None
) -> list[Any]:
    """One instance of the method for each joint."""
    values = {key: [value] * joints for key, value in _preset(method, name, preset).items()}
    known = [field.name for field in fields(method)]
    for text in settings:
        key, sign, value = text.partition("=")
        if not sign:
            raise UsageFault(f"--set {text}: write NAME=VALUE")
        if key not in known:
            choice = ", ".join(known) or "none"
            raise UsageFault(f"--set {text}: {name} has no setting {key!r}; it has {choice}")
        values[key] = per_joint(_numbers(text, value), joints, f"--set {key}")
    return [method(**{key: row[joint] for key, row in values.items()}) for joint in range(joints)]


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
