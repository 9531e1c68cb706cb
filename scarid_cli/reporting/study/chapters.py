"""The chapters of the page of one study, in the order in which they are read."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from scarid_cli.reporting import published
from scarid_cli.reporting.estimates import said_of
from scarid_cli.reporting.gains import gains
from scarid_cli.reporting.kinds import (
    OF_NO_METHOD,
    Hung,
    JointGains,
    Loads,
    Measurement,
    Metrics,
    MotionEstimate,
    Parameters,
    Prediction,
    Result,
    Trace,
)
from scarid_cli.reporting.loads import loads, payloads
from scarid_cli.reporting.parts import Section
from scarid_cli.reporting.study import estimation, signals
from scarid_cli.reporting.study.blocks import Chapter, Grid
from scarid_cli.reporting.study.ranking import ranking
from scarid_cli.reporting.study.view import View
from scarid_cli.reporting.wording import of_kind


def view_of(results: Sequence[Result]) -> View:
    """The order and the colours of the methods among these results."""
    labels = (r.name.label for r in results if not isinstance(r, OF_NO_METHOD))
    colours = {name: i for i, name in enumerate(dict.fromkeys(labels))}
    return View(ranking(results), colours)


def chapters(
    view: View, results: Sequence[Result], values: published.Values | None = None
) -> Iterator[Chapter]:
    """Everything that these results have to say, with published values beside them."""
    values = values or {}
    results = published.beside(results, values)
    torques = [r for r in results if isinstance(r, (Metrics, Prediction))]
    estimated = [*estimation.parameters(view, of_kind(results, Parameters))]
    yield from estimation.methods(view)
    yield from estimation.changed(said_of(results))
    yield from estimated[:1]
    yield from signals.torques(view, torques)
    yield from signals.sensors(view, of_kind(results, MotionEstimate))
    yield from estimation.over_time(view, of_kind(results, Trace))
    yield from estimated[1:]
    yield from signals.logs(view, of_kind(results, Measurement))
    yield from map(_plain, gains(of_kind(results, JointGains)))
    yield from map(_plain, payloads(of_kind(results, Hung)))
    yield from map(_plain, loads(of_kind(results, Loads)))
    yield from map(_plain, published.settings(results, values))


def of_sections(sections: Sequence[Section]) -> Iterator[Chapter]:
    """Sections as they are on the terminal, each as a chapter."""
    return map(_plain, sections)


def _plain(section: Section) -> Chapter:
    blocks = (Grid(section),) if section.rows else ()
    return Chapter(section.title, section.title, section.note, (), blocks)
