"""However the rows are cut into batches, a stage gives the same bits."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pyarrow as pa
import pytest
from conftest import seeds
from hypothesis import given, settings
from hypothesis import strategies as st
from stages.tables import SCARA, Kept, collected, motion, references, table
from unit.support import GIVEN, without_search

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS, ESTIMATORS
from scarid_cli.algorithms.filters.butterworth import Butterworth, ZeroPhase
from scarid_cli.algorithms.plants.controllers import law
from scarid_cli.algorithms.plants.loop import ClosedLoop
from scarid_cli.io.table import Table
from scarid_cli.stages.differentiate import differentiate, matched
from scarid_cli.stages.filter import filtered
from scarid_cli.stages.identify import identify
from scarid_cli.stages.results.changes import Known
from scarid_cli.stages.results.parameters import Identified
from scarid_cli.stages.simulate import simulate
from scarid_cli.stages.validate import validate

Stage = Callable[[Table], Table]

SIZES = st.lists(st.sampled_from([1, 2, 7, 64, 8192]), min_size=1, max_size=4)


def differentiated(name: str) -> Stage:
    return lambda source: differentiate(source, [without_search(name)] * 2)


def matching(name: str) -> Stage:
    return lambda source: matched(source, [without_search(name)] * 2)


def identified(name: str) -> Stage:
    return lambda source: identify(source, SCARA, ESTIMATORS.load(name)(), SCARA.apriori)


def simulated(source: Table) -> Table:
    loop = ClosedLoop(
        robot=SCARA,
        law=replace(law(SCARA), velocity_cutoff=50.0),
        encoder_resolution=np.full(2, 1e-4),
        position_noise=np.full(2, 1e-5),
        torque_noise=np.full(2, 0.1),
        seed=3,
    )
    return simulate(source, loop, 250.0, truth=True)


def changed(source: Table) -> Table:
    """With a verdict on what has changed, in a column of its own."""
    before = Known(None, np.full(8, 0.01))
    result = validate(source, Identified(SCARA, 1.1 * SCARA.apriori, 0.0), before=before)
    (batch,) = result.batches
    said = pa.array([str(result.meta.extra["change"])] * batch.num_rows)
    batch = batch.append_column("change", said)
    return replace(result, schema=batch.schema, batches=iter([batch]))


STAGES: dict[str, Stage] = {
    "filter": lambda source: filtered(source, dict.fromkeys(["q1", "tau2"], Butterworth(20.0))),
    "filter zero-phase": lambda source: filtered(
        source, dict.fromkeys(["q1", "tau2"], ZeroPhase(20.0))
    ),
    "validate": lambda source: validate(source, Identified(SCARA, SCARA.apriori, 0.0)),
    "validate, early": lambda source: validate(source, Identified(SCARA, SCARA.apriori, 2e-3)),
    "validate, behind a low-pass": lambda source: validate(
        source, Identified(SCARA, SCARA.apriori, -7e-3, low_pass=True)
    ),
    "validate, changed": changed,
    "simulate": simulated,
    **{f"differentiate {name}": differentiated(name) for name in DIFFERENTIATORS.names},
    **{f"differentiate {name} --match": matching(name) for name in DIFFERENTIATORS.names},
    **{f"identify {name}": identified(name) for name in ESTIMATORS.names},
}


@pytest.mark.parametrize("name", STAGES)
@given(sizes=SIZES)
@settings(max_examples=len(seeds(2, 8)), deadline=None)
def test_a_stage_gives_the_same_bits_however_its_rows_arrive(name: str, sizes: list[int]) -> None:
    assert collected(STAGES[name](table(source_of(name), sizes))).equals(at_once(name))


@pytest.mark.parametrize("stage", [differentiate, matched])
@pytest.mark.parametrize("name", GIVEN)
def test_settings_found_in_a_record_are_the_same_however_its_rows_arrive(
    name: str, stage: Callable[..., Table]
) -> None:
    def found(sizes: list[int]) -> pa.Table:
        methods = [DIFFERENTIATORS.load(name)()] * 2
        return collected(stage(table(motion(60), sizes), methods))

    assert found([1, 7, 2]).equals(found([]))


def source_of(name: str) -> dict[str, np.ndarray]:
    return references() if name == "simulate" else motion()


@cache
def at_once(name: str) -> pa.Table:
    return collected(STAGES[name](table(source_of(name))))


@given(sizes=SIZES)
@settings(max_examples=len(seeds(4, 8)), deadline=None)
def test_a_trace_has_the_same_bits_however_its_rows_arrive(sizes: list[int]) -> None:
    def trace(cuts: list[int]) -> Kept:
        kept = Kept()
        rls = ESTIMATORS.load("rls")(forgetting=0.99)
        identify(table(motion(), cuts), SCARA, rls, np.zeros(8), trace=kept)
        return kept

    assert trace(sizes).table.equals(trace([]).table)
