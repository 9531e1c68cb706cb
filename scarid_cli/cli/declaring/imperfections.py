"""From `--with NAME=VALUE[,VALUE...]` to the imperfections of a simulated robot, and their help."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import click

from scarid_cli.algorithms.imperfections.registry import (
    PLACES,
    Imperfections,
    declared_in,
    values_of,
)
from scarid_cli.cli.declaring import pairs
from scarid_cli.cli.declaring.headings import Command
from scarid_cli.errors import UsageFault


class WithImperfections(Command):
    """A command whose help ends with one line for each imperfection: name, unit and meaning."""

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:  # noqa: ARG002
        kinds = [kind for place in PLACES for kind in declared_in(place)]
        width = max(len(kind.NAME) for kind in kinds)
        wide = max(len(kind.unit()) for kind in kinds)
        formatter.write(
            "\nImperfections, for --with NAME=VALUE and for [imperfections] of a description:\n"
        )
        for place in PLACES:
            with formatter.section(f"  {place}"):
                starts = [f"{k.NAME:<{width}}  {k.unit():<{wide}}" for k in declared_in(place)]
                meanings = [kind.summary() for kind in declared_in(place)]
                formatter.write_dl(list(zip(starts, meanings, strict=True)), col_max=60)


def imperfections(
    texts: Iterable[str],
    shorthands: dict[str, tuple[float, ...] | None],
    described: dict[str, tuple[float, ...]],
    joints: int,
) -> Imperfections:
    """Those of every --with, those of the options of the same names, and those of the description.

    An imperfection that an option gives replaces that of the description.
    """
    given: dict[str, tuple[float, ...]] = {}
    for option, name, values in _entries(texts, shorthands):
        if name in given:
            raise UsageFault(f"{option}: {name} is given twice; give it once")
        try:
            given[name] = values_of(name, values, joints)
        except ValueError as error:
            raise UsageFault(f"{option}: {error}") from None
    found = Imperfections(joints, {**described, **given})
    try:
        found.check()
    except ValueError as error:
        raise UsageFault(str(error)) from None
    return found


Entry = tuple[str, str, Sequence[object]]


def _entries(
    texts: Iterable[str], shorthands: dict[str, tuple[float, ...] | None]
) -> Iterator[Entry]:
    """The option as it was written, the name of its imperfection, and its values."""
    for text in texts:
        name, value = pairs.pair(text, "--with")
        yield f"--with {text}", name, [part.strip() for part in value.split(",")]
    for option, values in shorthands.items():
        if values is not None:
            name = option.replace("_", "-")
            yield f"--{name}", name, values
