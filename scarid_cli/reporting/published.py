"""Published values: they become results that stand beside those of the tables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import nan

from scarid_cli.algorithms.inference.prediction import Quality
from scarid_cli.io.table import Table
from scarid_cli.printable import printable
from scarid_cli.reporting.kinds import Metrics, Parameters, Result, Trace
from scarid_cli.reporting.parts import NONE, Section

# By method, experiment, quantity and measure.
Values = dict[tuple[str, str, str, str], float]


def read(table: Table) -> Values:
    """The values in a table of the kind `published`."""
    values: Values = {}
    for batch in table.batches:
        rows = batch.to_pydict()
        experiments = rows.get("experiment", [""] * batch.num_rows)
        keys = zip(rows["method"], experiments, rows["quantity"], rows["measure"], strict=True)
        for (method, experiment, quantity, measure), value in zip(keys, rows["value"], strict=True):
            values[printable(method), experiment or "", quantity, measure] = value
    return values


def beside(results: Sequence[Result], values: Values) -> list[Result]:
    """The results, each followed by the published one of its method and experiment."""
    found: list[Result] = []
    for result in results:
        found.append(result)
        published = _published(result, values)
        if published:
            found.append(published)
    return found


def _published(result: Result, values: Values) -> Result | None:
    method, experiment = result.name.label, result.name.experiment
    name = replace(result.name, published=True)

    def of(quantity: str, measure: str) -> float:
        return values.get((method, experiment, quantity, measure), nan)

    if not any(key[:2] == (method, experiment) for key in values):
        return None
    if isinstance(result, Parameters):
        estimates = tuple(of(p, "estimate") for p in result.names)
        known = tuple(of(p, "relative_deviation") for p in result.names)
        plain = replace(result, name=name, extra={}, robust=(), low=(), high=())
        return replace(plain, estimates=estimates, deviations=known)
    if isinstance(result, Trace):
        errors = tuple(of(p, "rms_error") for p in result.names)
        return replace(result, name=name, curves=(), errors=errors)
    if isinstance(result, Metrics):
        qualities = tuple(
            Quality(of(f"tau{i}", "r2"), of(f"tau{i}", "rmse"), nan, 0) for i in result.joints
        )
        return replace(result, name=name, qualities=qualities)
    return None


def settings(results: Sequence[Result], values: Values) -> list[Section]:
    """Published settings beside the options of the commands that were run."""
    rows = []
    for result in results:
        if not isinstance(result, Parameters) or result.name.published or result.name.experiment:
            continue
        method = result.name.label
        given = [f"{q} = {v:g}" for (m, _, q, measure), v in values.items()
                 if (m, measure) == (method, "setting")]  # fmt: skip
        used = (_options(result.commands, name) for name in ("differentiate", "identify"))
        rows.append((method, ", ".join(given) or NONE, *used))
    if not rows or not values:
        return []
    note = "Published settings, and the options with which each command was run here."
    headers = ("method", "published", "differentiate", "identify")
    return [Section("Settings", note, headers, tuple(rows), texts=4)]


def _options(commands: Sequence[str], name: str) -> str:
    """The options of the last run of a command, without its files."""
    runs = [c.split()[2:] for c in commands if c.split()[1] == name]
    words = [word for word in (runs[-1] if runs else []) if "/" not in word and word != "--trace"]
    return " ".join(words) or NONE
