"""Compare identifications of a robot: which parameters differ by more than their errors allow."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.uncertainty.comparison import (
    LEVEL,
    MOST_FREEDOM,
    Comparison,
    Estimate,
    comparison,
    freedom_of,
    trend,
)
from scarid_cli.arrays import Array
from scarid_cli.errors import BadData, bad_data
from scarid_cli.io import schemas
from scarid_cli.io.table import Table, table_of
from scarid_cli.stages.results.estimates import array_of, errors_of
from scarid_cli.stages.results.parameters import GAINS, WIDENED_BY_GAINS

SAME, DIFFER = "same", "differ"  # verdicts
GAIN = "gain of joint "  # how the name of one begins
SHOWN = 5  # parameters that a message names at most
MOST_ROWS = 3  # tables from which there is a trend


@dataclass(frozen=True)
class Identification:
    """The content of a parameter table: names, units, meanings, and estimates.

    `dropped` are parameters that `identify --essential` set to zero and whose estimates are not
    known. A fitted delay is the last parameter.
    """

    table: Table
    names: list[str]
    units: list[str]
    meanings: list[str]
    estimate: Estimate
    dropped: frozenset[str]

    @classmethod
    def of(cls, table: Table) -> Identification:
        """Read a parameter table, with the covariance in its metadata."""
        whole = pa.Table.from_batches(list(table.batches), table.schema)
        extra = table.meta.extra
        names, units = (whole.column(key).to_pylist() for key in ("parameter", "unit"))
        values, errors = whole.column("estimate").to_numpy(), errors_of(whole)
        covariance = _covariance(table, len(names))
        unknown = set(extra.get("dropped", [])) or _zeros(names, values, errors)
        if "full_estimates" in extra and covariance is not None:
            values = array_of(table, "full_estimates", extra["full_estimates"], (len(names),))
            errors, unknown = np.sqrt(np.diag(covariance)), set()
        if WIDENED_BY_GAINS in extra and not unknown:
            wide, along = (array_of(table, WIDENED_BY_GAINS, x, (len(names),))
                           for x in extra[WIDENED_BY_GAINS])  # fmt: skip
            errors = np.sqrt(np.maximum(errors**2 - wide**2, 0.0))
            covariance = None if covariance is None else covariance - np.outer(along, along)
        freedom = _freedom(whole)
        if extra.get("delay") is not None and extra.get("delay_error"):
            names, units = [*names, "delay"], [*units, "s"]
            values = np.append(values, extra["delay"])
            errors, freedom = (
                np.append(errors, extra["delay_error"]),
                np.append(freedom, freedom[0]),
            )
            if covariance is not None:
                covariance = np.pad(covariance, (0, 1))
        gains = extra.get(GAINS, {})
        names = [*names, *(f"{GAIN}{joint}" for joint in gains)]
        units = [*units, *("" for _ in gains)]
        values = np.append(values, [factor for factor, _ in gains.values()])
        errors = np.append(errors, [error for _, error in gains.values()])
        freedom = np.append(freedom, np.full(len(gains), freedom[0]))
        if covariance is not None:
            covariance = np.pad(covariance, (0, len(gains)))
        meanings = (
            whole.column("stands_for").to_pylist() if "stands_for" in whole.column_names else []
        )
        estimate = Estimate(values, errors, freedom, covariance)
        return cls(table, names, units, meanings, estimate, frozenset(unknown))

    def of_names(self, names: list[str]) -> Estimate:
        """The estimates of some parameters."""
        at = [self.names.index(name) for name in names]
        e = self.estimate
        covariance = None if e.covariance is None else e.covariance[np.ix_(at, at)]
        return Estimate(e.values[at], e.errors[at], e.freedom[at], covariance)


def compare(tables: Sequence[Table]) -> tuple[Table, list[str]]:
    """The table of differences, each table with the first one, and what there is to report."""
    found = [Identification.of(table) for table in tables]
    for other in found[1:]:
        _require_comparable(found[0], other)
    names = _common(found)
    units = [found[0].units[found[0].names.index(name)] for name in names]
    estimates = [one.of_names(names) for one in found]
    pairs = [comparison(estimates[0], other) for other in estimates[1:]]
    trends = trend(estimates) if len(estimates) >= MOST_ROWS else None
    labels = [table.name for table in tables[1:]]
    lines = [*_remarks(found, names)]
    for label, pair in zip(labels, pairs, strict=True):
        start = f"{label}: " if len(labels) > 1 else ""
        lines.append(f"{start}{verdict(pair)}: {reason(pair, names, units)}")
    if trends:
        lines.append(_trend_sentence(trends, names, units, len(tables)))
    facts = [
        {**_facts(label, pair, names), "reason": reason(pair, names, units)}
        for label, pair in zip(labels, pairs, strict=True)
    ]
    trending = (
        {
            "parameters": [names[i] for i in trends.differing],
            "per_table": {names[i]: trends.difference[i] for i in trends.differing},
        }
        if trends
        else None
    )
    table = _table(tables[0], labels, names, units, estimates, pairs)
    extra: dict[str, Any] = {"comparisons": facts, "level": LEVEL, "trend": trending}
    return replace(table, meta=replace(table.meta, extra=extra)), lines


def verdict(pair: Comparison) -> str:
    """Whether two tables are of the same robot, as far as their errors tell."""
    return DIFFER if pair.differ else SAME


def reason(pair: Comparison, names: list[str], units: list[str]) -> str:
    """Why two tables differ, or how close they are."""
    joint = pair.joint
    together = ""
    if joint:
        together = (
            f"; all together F({joint.k}, {joint.n:.0f}) {joint.f:.3g}, p {joint.p_value:.2g}"
        )
    if not pair.differ:
        most = float(np.nanmax(np.abs(pair.counts), initial=0.0))
        return f"the estimates are at most {_count(most)} errors apart{together}"
    if not pair.differing:
        return f"no single parameter, but all together{together}"
    listed = _listed(pair, names, units)
    return f"{len(pair.differing)} of {len(names)} parameters: {listed}{together}"


def _trend_sentence(trends: Comparison, names: list[str], units: list[str], count: int) -> str:
    if not trends.differing:
        return f"no trend over the {count} tables"
    return f"trend over the {count} tables, per table: {_listed(trends, names, units)}"


def _listed(pair: Comparison, names: list[str], units: list[str]) -> str:
    texts = [
        f"{names[i]} {pair.difference[i]:+.3g} {units[i]} ({_count(abs(pair.counts[i]))} errors)"
        for i in pair.differing[:SHOWN]
    ]
    return ", ".join(texts) + (", ..." if len(pair.differing) > SHOWN else "")


def _count(errors: float) -> str:
    """How many errors apart, in two digits, without an exponent."""
    return f"{errors:,.0f}" if errors >= 10.0 else f"{errors:.2g}"


def _facts(label: str, pair: Comparison, names: list[str]) -> dict[str, Any]:
    joint = pair.joint
    return {
        "table": label,
        "verdict": verdict(pair),
        "differ": pair.differ,
        "parameters": [names[i] for i in pair.differing],
        "joint": joint and {"f": joint.f, "k": joint.k, "n": joint.n, "p_value": joint.p_value},
    }


def _require_comparable(first: Identification, other: Identification) -> None:
    """Refuse a table of another robot, with other parameters, or in other units."""
    robots = [one.table.meta.robot for one in (first, other)]
    if all(robots) and len({Path(str(name)).name for name in robots}) > 1:
        raise _unlike(first, other, f"robot {robots[1]}", f"{robots[0]}")
    own, others = (
        [n for n in one.names if n != "delay" and not n.startswith(GAIN)] for one in (first, other)
    )
    if own != others:
        only = sorted(set(own) ^ set(others))
        raise _unlike(
            first, other, f"other parameters ({', '.join(only[:SHOWN])})", "the same ones"
        )
    for name in own:
        i = first.names.index(name)
        if first.units[i] != other.units[i]:
            raise _unlike(first, other, f"{name} in {other.units[i]}", f"{first.units[i]}")
        if first.meanings and other.meanings and first.meanings[i] != other.meanings[i]:
            raise _unlike(first, other, f"{name} = {other.meanings[i]}", f"{first.meanings[i]}")


def _unlike(first: Identification, other: Identification, found: str, expected: str) -> BadData:
    return bad_data(
        other.table.name,
        found,
        expected=f"{expected}, as in {first.table.name}",
        remedy="compare identifications of one robot with one description",
    )


def _common(found: Sequence[Identification]) -> list[str]:
    """The parameters that every table has an estimate of."""
    names = [
        name
        for name in found[0].names
        if all(name in one.names and name not in one.dropped for one in found)
    ]
    if not names:
        raise BadData(f"{found[1].table.name}: no parameter was identified in all tables")
    return names


def _remarks(found: Sequence[Identification], names: list[str]) -> Iterator[str]:
    """What could not be compared, and what is not known."""
    every = dict.fromkeys(x for one in found for x in one.names)
    missing = [n for n in every if n not in names and not n.startswith(GAIN)]
    if missing:
        listed = ", ".join(missing[:SHOWN]) + (", ..." if len(missing) > SHOWN else "")
        yield f"not in every table, or dropped there, and therefore not compared: {listed}"
    full = [one.table.name for one in found if "full_estimates" in one.table.meta.extra]
    if full and not any(one.dropped for one in found):
        yield f"compared are the estimates before --essential dropped any: {', '.join(full)}"
    lost = [one.table.name for one in found if one.estimate.covariance is None]
    if lost:
        yield (
            f"no joint test, because there is no covariance (CSV cannot hold it): {', '.join(lost)}"
        )


def _covariance(table: Table, rows: int) -> Array | None:
    stored = table.meta.extra.get("covariance")
    return None if stored is None else array_of(table, "covariance", stored, (rows, rows))


def _zeros(names: list[str], values: Array, errors: Array) -> set[str]:
    """Parameters that are exactly zero and have no error although others do: dropped, in a CSV."""
    if not np.isfinite(errors).any():
        return set()
    return {names[i] for i in np.flatnonzero((values == 0.0) & ~np.isfinite(errors))}


def _freedom(whole: pa.Table) -> Array:
    if not {"low", "high", "robust_error"} <= set(whole.column_names):
        return np.full(whole.num_rows, MOST_FREEDOM)
    low, high, errors = (whole.column(n).to_numpy() for n in ("low", "high", "robust_error"))
    return freedom_of(errors, 0.5 * (high - low))


def _table(
    first: Table,
    labels: list[str],
    names: list[str],
    units: list[str],
    estimates: list[Estimate],
    pairs: list[Comparison],
) -> Table:
    rows = (
        (label, *row)
        for label, other, pair in zip(labels, estimates[1:], pairs, strict=True)
        for row in zip(
            names,
            units,
            *(x.tolist() for x in (estimates[0].values, other.values, pair.difference)),
            *(x.tolist() for x in (pair.errors, pair.counts, pair.p_values)),
            strict=True,
        )
    )
    meta = replace(first.meta, kind="comparison", extra={})
    return table_of("compare", schemas.load("comparison").arrow(), rows, meta)
