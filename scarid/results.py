"""What the functions return: tables with their verdict, documents, and what was said of them."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pyarrow as pa

from scarid_cli.algorithms.checks.finding import STATUSES
from scarid_cli.errors import REQUIRED, ScaridError, UsageFault
from scarid_cli.io.table import Metadata, Table

if TYPE_CHECKING:
    import numpy as np

FEW = 200  # rows of a table that is shown as a whole
HEAD = 5  # rows that are shown of a longer one
COLOURS = {"good": "#1a7f37", "unchanged": "#1a7f37", "same": "#1a7f37", "rough": "#9a6700"}
OTHERWISE = "#cf222e"
JUDGED = ("parameters", "metrics", "comparison")  # kinds of tables


class Log:
    """A table that a command wrote: its columns by name, its facts, and the `messages` of the run.

    `meta` are the facts that the table keeps (kind, robot, period [s], history, and `extra`).
    """

    def __init__(self, table: Table, messages: Sequence[str] = ()) -> None:
        self.schema = table.arrow_schema()
        self.meta: Metadata = table.meta
        self.messages = tuple(messages)
        self._table = pa.Table.from_batches(list(table.batches), table.schema)

    def __getitem__(self, column: str) -> np.ndarray[Any, Any]:
        """The values of a column."""
        if column not in self._table.column_names:
            raise KeyError(f"{column}: there are {', '.join(self._table.column_names)}")
        values: np.ndarray[Any, Any] = self._table.column(column).to_numpy()
        return values

    def __len__(self) -> int:
        return int(self._table.num_rows)

    def __iter__(self) -> Iterator[str]:
        """The names of the columns, as those of a frame."""
        return iter(self.columns)

    def __contains__(self, column: object) -> bool:
        return column in self.columns

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        """The table, for whatever reads Arrow: `pa.table(log)`, `polars.DataFrame(log)`."""
        return self.to_arrow().__arrow_c_stream__(requested_schema)

    @property
    def columns(self) -> list[str]:
        """The names of the columns."""
        return list(self._table.column_names)

    def to_arrow(self) -> pa.Table:
        """The table of Arrow, with the metadata of scarid."""
        return self._table.cast(self.schema).replace_schema_metadata(self.schema.metadata)

    def to_pandas(self) -> Any:
        """The frame of pandas, which must be installed."""
        return self._table.to_pandas()

    def to_polars(self) -> Any:
        """The frame of polars, which must be installed."""
        import polars  # type: ignore[import-not-found, unused-ignore]

        return polars.from_arrow(self._table)

    def save(self, path: str | Path) -> None:
        """Write a file: CSV, Parquet (.parquet) or Arrow (.arrow) by its ending, as `-o` does."""
        from scarid_cli.io.writer import Output, all_or_none

        outputs: list[Any] = []
        with all_or_none(outputs):
            outputs.append(output := Output(str(path), None))
            output.take(self._whole())

    def _whole(self) -> Table:
        from scarid_cli.io.arrowio import of_arrow

        table = self.to_arrow()
        return of_arrow("<result>", table.schema, iter(table.to_batches()))

    def _shown(self) -> pa.Table:
        return self._table if len(self) <= FEW else self._table.slice(0, HEAD)

    def __repr__(self) -> str:
        from scarid_cli.reporting.readable import readable

        kind = (self.meta.kind or "table").capitalize()
        if len(self) <= FEW:
            return readable(kind, self._table).rstrip()
        rate = f", {1.0 / self.meta.period:.6g} Hz" if self.meta.period else ""
        return f"{kind}: {len(self)} rows{rate}; {', '.join(self.columns)}"

    def _repr_html_(self) -> str:
        table = self._shown()
        head = "".join(f"<th>{escape(name)}</th>" for name in table.column_names)
        rows = "".join(
            f"<tr>{''.join(f'<td>{escape(_cell(x))}</td>' for x in row.values())}</tr>"
            for row in table.to_pylist()
        )
        more = f"<p>{len(self)} rows, of which the first {len(table)} are shown</p>"
        tail = more if len(table) < len(self) else ""
        return f"<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>{tail}"


class Judged(Log):
    """A table with a verdict: parameters, or how a log or a robot differs from them."""

    @property
    def verdict(self) -> str:
        """Of parameters good, rough, doubtful or not identifiable; else unchanged, changed, same.

        It is empty if there is none.
        """
        return str(self._judgement.get("verdict") or "")

    @property
    def reasons(self) -> list[str]:
        """Why, and the key figures, in plain words."""
        found = self._judgement
        return list(found.get("reasons") or [found[key] for key in ("reason",) if found.get(key)])

    @property
    def _judgement(self) -> dict[str, Any]:
        extra = self.meta.extra
        compared = extra.get("comparisons") or [{}]
        return extra.get("change") or (extra if "verdict" in extra else compared[-1])

    def __getitem__(self, column: str) -> Any:
        """The values of a column, or the estimate of a parameter."""
        if column not in self.columns and {"parameter", "estimate"} <= set(self.columns):
            names = self._table.column("parameter").to_pylist()
            if column in names:
                return self._table.column("estimate")[names.index(column)].as_py()
        return super().__getitem__(column)

    @property
    def estimates(self) -> dict[str, float]:
        """The estimates by name, of parameters."""
        if "estimate" not in self.columns:
            raise KeyError(f"no estimates in a table of {self.meta.kind}; see its columns")
        names = self._table.column("parameter").to_pylist()
        return dict(zip(names, self._table.column("estimate").to_pylist(), strict=True))

    @property
    def covariance(self) -> np.ndarray[Any, Any]:
        """The covariance of the estimates, in their order, with what may be beyond the model.

        That of the noise is scaled by one factor; the column `robust_error` has each one's own.
        """
        import numpy as np

        found = self.meta.extra.get("covariance")
        if found is None:
            raise KeyError(f"no covariance in this table of {self.meta.kind}")
        return np.array(found, dtype=np.float64)

    def torques(self, q: Any, dq: Any, ddq: Any) -> np.ndarray[Any, Any]:
        """The torques [N m or N] that the identified robot needs for a motion.

        q [rad or m], dq and ddq are (joints), or (samples, joints), as is the result. It has what
        the parameters say, as `export` has it, and not what was fitted beside them.
        """
        import numpy as np

        from scarid_cli.algorithms.robots.reading import load
        from scarid_cli.stages.results.parameters import identified

        found = identified(self._whole(), load(self.meta.robot or ""))
        motion = [np.atleast_2d(np.asarray(x, dtype=np.float64)) for x in (q, dq, ddq)]
        shape = (len(motion[0]), len(found.robot.joints))
        if any(x.shape != shape for x in motion):
            shapes = ", ".join(str(x.shape) for x in motion)
            raise UsageFault(f"q, dq and ddq are {shapes}; give (samples, {shape[1]}) for each")
        W = found.robot.regressor(*(np.ascontiguousarray(x.T) for x in motion))
        tau = found.robot.torques(W, found.theta).T
        return np.ascontiguousarray(tau[0] if np.ndim(q) == 1 else tau)

    def __repr__(self) -> str:
        said = f"\n{self.verdict}: {'; '.join(self.reasons)}" if self.verdict else ""
        return f"{super().__repr__()}{said}"

    def _repr_html_(self) -> str:
        if not self.verdict:
            return super()._repr_html_()
        colour = COLOURS.get(self.verdict, OTHERWISE)
        reasons = "; ".join(self.reasons)
        line = f'<p><b style="color:{colour}">{escape(self.verdict)}</b>: {escape(reasons)}</p>'
        return f"{line}{self._forest() or super()._repr_html_()}"

    def _forest(self) -> str:
        """The estimates with their 95 % intervals, drawn; empty if there are none."""
        if not {"parameter", "estimate", "low", "high"} <= set(self.columns):
            return ""
        rows = "".join(_forest_row(row) for row in self._table.to_pylist())
        head = "<th>parameter</th><th>unit</th><th>estimate</th><th>95 % interval</th><th></th>"
        return f"<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>"


def _forest_row(row: dict[str, Any]) -> str:
    estimate, low, high = row["estimate"], row["low"], row["high"]
    known = low is not None and high is not None and low == low and high == high
    interval = f"{low:.4g} to {high:.4g}" if known else ""
    picture = _interval(estimate, low, high) if known else ""
    cells = (row["parameter"], row["unit"] or "", f"{estimate:.4g}", interval)
    return f"<tr>{''.join(f'<td>{escape(str(x))}</td>' for x in cells)}<td>{picture}</td></tr>"


def _interval(estimate: float, low: float, high: float) -> str:
    """The interval on a line from zero to the farther end, so that lengths say what is known."""
    far = max(abs(low), abs(high)) or 1.0
    place = [100.0 + 90.0 * x / far for x in (low, estimate, high)]
    return (
        '<svg width="200" height="14" role="img"><line x1="100" y1="0" x2="100" y2="14" '
        'stroke="#999"/>'
        f'<line x1="{place[0]:.1f}" y1="7" x2="{place[2]:.1f}" y2="7" stroke="#0969da" '
        'stroke-width="3"/>'
        f'<circle cx="{place[1]:.1f}" cy="7" r="4" fill="#0969da"/></svg>'
    )


class Text(str):
    """A document of a command without a table, with the `messages` of the run."""

    messages: tuple[str, ...]

    def __new__(cls, text: str, messages: Sequence[str] = ()) -> Text:
        made = super().__new__(cls, text)
        made.messages = tuple(messages)
        return made

    @property
    def data(self) -> Any:
        """The content of a JSON document."""
        return json.loads(self)

    def lines(self) -> Iterator[str]:
        """Its lines."""
        return iter(self.splitlines())

    def save(self, path: str | Path) -> None:
        """Write it to a file."""
        Path(path).write_text(self, encoding="utf-8")


class Checked(Text):
    """What `check` found: a document, shown by its findings."""

    @property
    def status(self) -> str:
        """The worst of the findings: ok, warning or failed."""
        return str(self.data["status"])

    @property
    def findings(self) -> list[dict[str, str]]:
        """The name, status, figure and advice of what is not ok."""
        return [found for found in self.data["checks"] if found["status"] != "ok"]

    @property
    def counts(self) -> str:
        """`24 ok, 1 warning, 0 failed`."""
        every = [found["status"] for found in self.data["checks"]]
        return ", ".join(f"{every.count(status)} {status}" for status in STATUSES)

    def __repr__(self) -> str:
        lines = [f"{x['status']:8} {x['name']:16} {x['figure']}" for x in self.findings]
        return "\n".join([*lines, self.counts])

    def _repr_html_(self) -> str:
        names = ("status", "name", "figure", "advice")
        head = "".join(f"<th>{name}</th>" for name in names)
        rows = "".join(
            f"<tr>{''.join(f'<td>{escape(x[name])}</td>' for name in names)}</tr>"
            for x in self.findings
        )
        table = f"<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>"
        return f"<p>{self.counts}</p>{table if rows else ''}"


class RequirementError(ScaridError):
    """The log, or the result, is not as it should be, as `require` says; see `result`."""

    status = REQUIRED

    def __init__(self, message: str, status: int, found: Any) -> None:
        super().__init__(message)
        self.status, self.result = status, found

    def __reduce__(self) -> tuple[type[RequirementError], tuple[str, int, Any]]:
        """As a process pool hands it on."""
        return type(self), (str(self), self.status, self.result)


def result(table: Table, messages: Sequence[str]) -> Log:
    """The result for a table: with a verdict, if its kind has one."""
    return (Judged if table.meta.kind in JUDGED else Log)(table, messages)


def _cell(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else "" if value is None else str(value)
