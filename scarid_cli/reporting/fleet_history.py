"""The history of a parameter over the logs of a robot, and its drawing as a small curve."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from math import floor, log10

import numpy as np
import pyarrow as pa

from scarid_cli.arrays import Array, Numbers
from scarid_cli.io.table import Table

KNOWN = 0.3  # relative error up to which a parameter is essential: that of identify's verdict


@dataclass(frozen=True)
class History:
    """Estimates of one parameter, in the order of the logs, with the ends of their 95 % intervals.

    `order` holds the places of the logs within the robot, `errors` the differences to the reference
    in standard errors. A value that is not known is nan.
    """

    parameter: str
    unit: str
    order: Numbers
    estimate: Array
    robust_error: Array
    low: Array
    high: Array
    errors: Array

    @cached_property
    def half(self) -> Array:
        """Half of the width of each interval; 0 if the interval is not known."""
        return np.nan_to_num((self.high - self.low) / 2.0, posinf=0.0, neginf=0.0)

    @property
    def essential(self) -> bool:
        """Whether the relative error is at most 30 % in the median over the logs."""
        known = np.isfinite(self.robust_error) & (self.estimate != 0.0)
        if not known.any():
            return False
        relative = self.robust_error[known] / np.abs(self.estimate[known])
        return bool(np.median(relative) <= KNOWN)

    @property
    def decimals(self) -> int:
        """The decimal places at which the interval of a typical log has two digits.

        The largest estimate has at most 15 digits with them.
        """
        largest = float(np.max(np.abs(self.estimate)))
        scale = float(np.median(self.half)) or largest / 1000.0
        if scale <= 0.0:
            return 0
        return min(1 - floor(log10(scale)), 14 - floor(log10(largest or scale)))

    @cached_property
    def limits(self) -> tuple[float, float]:
        """The vertical axis: without the outliers, which would flatten the rest of the curve."""
        low, high = np.percentile(self.estimate, (25, 75))
        margin = float(np.median(self.half))
        reach = 3.0 * (high - low) + 2.0 * margin
        inside = self.estimate[(self.estimate >= low - reach) & (self.estimate <= high + reach)]
        return float(inside.min() - margin), float(inside.max() + margin)


def histories(table: Table) -> Mapping[str, Mapping[str, History]]:
    """The histories by robot and parameter, from a table of kind `estimates`."""
    rows = pa.Table.from_batches(list(table.batches), schema=table.schema)
    names = (rows.column(c).to_pylist() for c in ("robot", "parameter"))
    places: dict[tuple[str, str], list[int]] = defaultdict(list)
    for place, key in enumerate(zip(*names, strict=True)):
        places[key].append(place)
    order = rows.column("order").combine_chunks().to_numpy()
    columns = {name: _numbers(rows, name) for name in NUMBERS}
    units = rows.column("unit")
    found: dict[str, dict[str, History]] = defaultdict(dict)
    for (robot, parameter), indices in places.items():
        chosen = np.array(sorted(indices, key=order.__getitem__))
        values = {name: column[chosen] for name, column in columns.items()}
        unit = str(units[indices[0]].as_py())
        found[robot][parameter] = History(parameter, unit, order[chosen], **values)
    return found


NUMBERS = ("estimate", "robust_error", "low", "high", "errors")


def _numbers(rows: pa.Table, column: str) -> Array:
    if column not in rows.column_names:
        return np.full(rows.num_rows, np.nan)
    values: Array = rows.column(column).combine_chunks().to_numpy(zero_copy_only=False)
    return values
