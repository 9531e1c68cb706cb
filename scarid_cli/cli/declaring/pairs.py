"""Options of the form NAME=VALUE."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from scarid_cli.errors import UsageFault


def pair(text: str, option: str) -> tuple[str, str]:
    """The name and the value."""
    name, sign, value = text.partition("=")
    if not sign or not name.strip() or not value.strip():
        raise UsageFault(f"{option} {text}: write NAME=VALUE")
    return name.strip(), value.strip()


def numbers(text: str, option: str) -> list[float]:
    """One number, or several separated by commas."""
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise UsageFault(f"{option}: {text!r} is not a number") from None


def settings(
    texts: Iterable[str], known: list[str], owner: str, option: str = "--set"
) -> Iterator[tuple[str, list[float]]]:
    """From every `--set NAME=VALUE[,VALUE...]`: the name and the values of a known setting."""
    for text in texts:
        name, value = pair(text, option)
        require_known(known, name, owner, f"{option} {text}: ")
        yield name, numbers(value, f"{option} {text}")


def single_settings(texts: Iterable[str], known: list[str], owner: str) -> dict[str, float]:
    """From every `--set NAME=VALUE`: the value of each known setting."""
    given = dict(settings(texts, known, owner))
    for name, values in given.items():
        if len(values) > 1:
            raise UsageFault(f"--set {name}: give one value, not {len(values)}")
    return {name: values[0] for name, values in given.items()}


def renamings(texts: Iterable[str]) -> dict[str, str]:
    """From every `--map NEW=OLD[,NEW=OLD...]`: the old name of each new column."""
    names: dict[str, str] = {}
    for text in texts:
        for part in text.split(","):
            new, old = pair(part, "--map")
            if new in names:
                raise UsageFault(
                    f"--map: {new!r} is given twice, for {names[new]!r} and for {old!r}; "
                    "write it once"
                )
            names[new] = old
    return names


def require_known(known: list[str], key: str, name: str, where: str = "") -> None:
    """The key must be a setting of the algorithm of this name."""
    if key not in known:
        choice = ", ".join(known) or "none"
        raise UsageFault(f"{where}{name} has no setting {key!r}; it has {choice}")
