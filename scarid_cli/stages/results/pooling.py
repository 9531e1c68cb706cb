"""Several identifications of a robot as one, for `scarid validate`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from scarid_cli.algorithms.beyond.additions import mean_additions
from scarid_cli.algorithms.changes.evidence import LogEvidence
from scarid_cli.algorithms.changes.pooling import pooled
from scarid_cli.errors import bad_data
from scarid_cli.stages.results.changes import Known
from scarid_cli.stages.results.parameters import Identified

Entry = tuple[str, Identified, Known]  # the name of a table, and its content


def pooled_identifications(tables: Sequence[Entry]) -> tuple[Identified, Known]:
    """The parameters of all tables, weighted by their information, and what is known of the logs.

    Each table must have the evidence of its log, and the same columns as the others.
    """
    _, model, before = tables[0]
    if len(tables) == 1:
        return model, before
    evidences = [_evidence(table) for table in tables]
    for table in tables[1:]:
        _require_alike(tables[0], table)
    models = [model for _, model, _ in tables]
    found = pooled([m.theta for m in models], [m.delay for m in models], evidences)
    errors = np.full_like(before.errors, np.nan)
    additions = mean_additions([m.additions for m in models])
    own = replace(model, theta=found.theta, delay=found.delay, additions=additions)
    return own, Known(found.evidence, errors, slow=before.slow)


def _evidence(table: Entry) -> LogEvidence:
    name, _, before = table
    if before.evidence is None:
        raise bad_data(
            name,
            "no evidence of the log",
            expected="that of each table where several are pooled",
            remedy="CSV does not keep it: write each one with `scarid identify -o FILE.parquet`",
        )
    return before.evidence


def _require_alike(first: Entry, other: Entry) -> None:
    """Refuse a table whose columns are other quantities than those of the first."""
    if first[1].robot != other[1].robot:
        raise bad_data(
            other[0],
            "other velocities of the Stribeck friction",
            expected=f"those of {first[0]}",
            remedy="give one table of the estimator `separable` only",
        )
