"""Titles, headings and cells that the sections of a report share."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from math import isfinite
from typing import TypeVar

from scarid_cli.reporting.kinds import Result
from scarid_cli.reporting.parts import NONE, number

R = TypeVar("R", bound=Result)


def of_kind(results: Sequence[Result], kind: type[R]) -> list[R]:
    """The results of one kind."""
    return [r for r in results if isinstance(r, kind)]


def grouped(results: Sequence[R], key: Callable[[R], Hashable]) -> list[list[R]]:
    """Results that can share a table, in the order of the first of each group."""
    groups: dict[Hashable, list[R]] = {}
    for result in results:
        groups.setdefault(key(result), []).append(result)
    return list(groups.values())


def experiment_of(result: Result) -> str:
    """The experiment that the name of the table states; empty if it states none."""
    return result.name.experiment


def shown(results: Sequence[Result]) -> list[str]:
    """The name of each result in a table or a legend."""
    return [result.name.shown for result in results]


def titled(title: str, experiment: str) -> str:
    """The title of a section, with the experiment if there is one."""
    return f"{title}: {experiment}" if experiment else title


def with_experiment(result: Result, name: str) -> str:
    """The name of a result outside the section of its experiment."""
    experiment = result.name.experiment
    return name if not experiment or name.endswith(experiment) else f"{name}, {experiment}"


def robots_of(results: Sequence[Result]) -> str:
    """A sentence that names the robots; empty if none is known."""
    names = dict.fromkeys(name for r in results if (name := r.robot_name))
    return f"Robot {', '.join(names)}. " if names else ""


def with_unit(name: str, unit: str) -> str:
    """A heading with its unit in brackets."""
    return f"{name} [{unit}]" if unit else name


def common_unit(units: Sequence[str]) -> str:
    """The unit of all; empty if they differ."""
    return units[0] if len(set(units)) == 1 else ""


def cells(result: Result, values: Sequence[float]) -> list[str]:
    """Four significant digits, but published values as they were printed."""
    return [_printed(x) if result.name.published else number(x) for x in values]


def _printed(value: float) -> str:
    return f"{value:g}" if isfinite(value) else NONE
