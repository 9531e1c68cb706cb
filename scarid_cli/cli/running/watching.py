"""The estimates so far, where a person waits at a terminal."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

from scarid_cli.algorithms.regression.information import NotIdentifiableError
from scarid_cli.arrays import Array
from scarid_cli.cli.running.job import Job
from scarid_cli.stages.identify import SoFar

EVERY = 0.5  # s
WIDEST = 60  # characters


def watcher(job: Job, names: Sequence[str]) -> Callable[[SoFar], None]:
    """A function that is offered what is known after each batch, and shows it now and then."""
    last = time.monotonic()

    def watch(so_far: SoFar) -> None:
        nonlocal last
        if job.quiet or time.monotonic() - last < EVERY:
            return
        last = time.monotonic()
        try:
            job.watched = text(names, so_far.estimates())
        except NotIdentifiableError:
            job.watched = "not yet identifiable"

    return watch


def text(names: Sequence[str], values: Array) -> str:
    """`ZZ1R 3.42, Fv1 0.0862, ...`: as many as fit."""
    shown = ""
    for name, value in zip(names, values, strict=False):
        one = f"{', ' if shown else ''}{name} {value:.3g}"
        if len(shown + one) > WIDEST:
            return f"{shown}, ..."
        shown += one
    return shown
