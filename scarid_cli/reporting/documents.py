"""The files of a report: either all of them are written, or none."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

from scarid_cli.io.writer import Target


@contextlib.contextmanager
def documents(*paths: str | None) -> Iterator[list[Target | None]]:
    """One target for each path, opened first: a path that cannot be written is reported at once."""
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
