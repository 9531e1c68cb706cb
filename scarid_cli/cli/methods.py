"""scarid methods"""

from __future__ import annotations

from collections.abc import Iterator
from difflib import get_close_matches
from typing import Any

import click

from scarid_cli.algorithms.choices.registry import (
    DIFFERENTIATORS,
    ESTIMATORS,
    EXCITATIONS,
)
from scarid_cli.cli.declaring import options
from scarid_cli.cli.running.terminal import wrapped
from scarid_cli.errors import UsageFault

REGISTRIES = {
    "differentiate --method": DIFFERENTIATORS,
    "identify --estimator": ESTIMATORS,
    "trajgen --excitation": EXCITATIONS,
}


@click.command(name="methods")
@click.argument("name", required=False, shell_complete=options.offered("methods"))
@options.common
def command(name: str | None, **_rest: Any) -> None:
    """List the methods that commands offer, or describe one: source, delay, rule and settings.

    \b
      scarid methods
      scarid methods kalman-lag
    """
    for line in _described(name) if name else _listed():
        click.echo(line)


def _listed() -> Iterator[str]:
    """All methods, each with the first line of its description."""
    width = max(len(name) for registry in REGISTRIES.values() for name in registry.names)
    for number, (option, registry) in enumerate(REGISTRIES.items()):
        yield from [""] * bool(number)
        yield option
        for name in registry.names:
            start = f"  {name:<{width}}  "
            yield wrapped(start, registry.summary(name), len(start))


def _described(name: str) -> Iterator[str]:
    """The descriptions of the methods of this name, which may be offered by two commands."""
    found = {option: registry for option, registry in REGISTRIES.items() if name in registry.names}
    if not found:
        raise UsageFault(f"no method {name!r}{_hint(name)}; `scarid methods` lists all")
    for number, (option, registry) in enumerate(found.items()):
        yield from [""] * bool(number)
        yield f"{option} {name}"
        yield from (f"  {line}".rstrip() for line in registry.describe(name).splitlines())


def _hint(name: str) -> str:
    names = {known for registry in REGISTRIES.values() for known in registry.names}
    near = get_close_matches(name, sorted(names), 1)
    return f" (did you mean {near[0]}?)" if near else ""
