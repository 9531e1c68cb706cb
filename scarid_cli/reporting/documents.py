"""The files of a report: all of them appear when it is whole, or none."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

from scarid_cli.io.writer import Target


@contextlib.contextmanager
def documents(*paths: str | None) -> Iterator[list[Target | None]]:
    """Where each document will go; opened before anything is read: mistakes show at once."""
    targets: list[Target | None] = []
    try:
        for path in paths:
            targets.append(Target(path) if path else None)  # noqa: PERF401 (those made are kept)
        yield targets
        for target in filter(None, targets):
            target.commit()
    except BaseException:
        for target in filter(None, targets):
            target.discard()
        raise
