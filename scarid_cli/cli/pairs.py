"""NAME=VALUE, as several options take it."""

from __future__ import annotations

from scarid_cli.errors import UsageFault


def pair(text: str, option: str) -> tuple[str, str]:
    """The name and the value."""
    name, sign, value = text.partition("=")
    if not sign or not name.strip() or not value.strip():
        raise UsageFault(f"{option} {text}: write NAME=VALUE")
    return name.strip(), value.strip()


def require_known(known: list[str], key: str, name: str, where: str = "") -> None:
    """The key must be a setting of the algorithm of this name."""
    if key not in known:
        choice = ", ".join(known) or "none"
        raise UsageFault(f"{where}{name} has no setting {key!r}; it has {choice}")
