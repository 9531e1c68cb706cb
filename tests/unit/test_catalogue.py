"""The catalogue of what a log may have beyond the model: what each entry states, and a round trip.

The logs are those of the benchmarks' simulator, which knows nothing of the catalogue.
"""

from __future__ import annotations

import re

import named
import pytest
from conftest import ROOT

from scarid_cli.algorithms.beyond.catalogue import PHENOMENA, PLACES, SINGLE, Entry, declared_in
from scarid_cli.algorithms.beyond.mounting import Tilt
from scarid_cli.algorithms.beyond.phenomenon import Composite
from scarid_cli.algorithms.beyond.rows import Reversals
from scarid_cli.algorithms.changes import hypotheses
from scarid_cli.algorithms.imperfections.registry import IMPERFECTIONS
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.algorithms.robots.terms import AXIS_TERMS
from scarid_cli.reporting import beyond

every_entry = pytest.mark.parametrize("name", PHENOMENA)
NAMED = [name for name, kind in PHENOMENA.items() if kind.LACKS]
# Of the horizontal arm, as the other one has an offset among its terms, or hides it.
# The first log of it is at an edge, which the rounding of a processor decides.
LATER_LOG = {"eccentric encoder": 1}
HORIZONTAL = {
    "torque offset",
    "asymmetric friction",
    "Stribeck friction",
    "cubic cable",
    "torque ripple",
    "friction drifts",
}


def test_every_entry_has_a_name_and_a_place_of_its_own() -> None:
    placed = [kind for place in PLACES for kind in declared_in(place)]
    assert all(declared_in(place) for place in PLACES)
    assert [kind.NAME for kind in placed] == list(SINGLE)


@every_entry
def test_an_entry_is_described_in_its_own_words(name: str) -> None:
    kind = PHENOMENA[name]
    assert "__doc__" in vars(kind)
    first = (kind.__doc__ or "").strip().split("\n\n")[0]
    assert first[0].isupper()
    assert first.endswith(".")


@pytest.mark.parametrize("name", NAMED)
def test_what_is_named_says_what_of_and_has_a_unit(name: str) -> None:
    kind = PHENOMENA[name]
    assert kind is Reversals or re.search(r"{(joints|gravity|zeros|distances)}", kind.LACKS)
    assert kind is Reversals or beyond.unit(kind)


@every_entry
def test_an_entry_refers_to_what_there_is(name: str) -> None:
    kind = PHENOMENA[name]
    assert {*kind.TERMS} <= AXIS_TERMS.keys()
    assert {*kind.IMPERFECTIONS} <= IMPERFECTIONS.keys()
    assert {*kind.WIDER} <= PHENOMENA.keys()
    assert kind.kind() in PHENOMENA
    if issubclass(kind, Composite):
        assert all(part.NAME in SINGLE for part in kind.PARTS)


@every_entry
def test_what_validate_calls_it_is_one_of_its_hypotheses(name: str) -> None:
    arm = load(str(ROOT / "samples" / "robots" / "ur10e.toml"))
    kinds = {hypothesis.kind for hypothesis in hypotheses.hypotheses(arm)}
    assert PHENOMENA[name].CHANGE in {"", *kinds}


def test_the_page_on_the_catalogue_is_up_to_date() -> None:
    assert (ROOT / "docs" / "beyond.md").read_text("utf-8") == beyond.page()


def test_every_entry_that_is_named_has_a_log_of_its_own() -> None:
    """A tilt has benchmarks/tilts.py; of reversals something else is always clearer."""
    shown: set[Entry] = {kind for kinds in named.LACKING.values() for kind in kinds}
    assert {PHENOMENA[name] for name in NAMED} - shown == {Tilt}


@pytest.mark.parametrize("condition", [name for name, kinds in named.LACKING.items() if kinds])
def test_what_the_log_has_is_named(condition: str) -> None:
    robot = "scara2" if condition in HORIZONTAL else "planar2-gravity"
    found = named.named((robot, condition, named.SEED + LATER_LOG.get(condition, 0)))
    says = f"{condition}, {robot}: the verdict names {[kind.NAME for kind in found]}"
    assert {*found} & {*named.LACKING[condition]}, says
