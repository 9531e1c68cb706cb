"""What holds for every imperfection of a simulated robot."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import seeds
from hypothesis import given, settings
from hypothesis import strategies as st
from stages.simulated import LOG_LEVEL, Values, closed_loop, log, simulated
from stages.tables import collected, references, table

from scarid_cli.algorithms.imperfections.registry import IMPERFECTIONS, Imperfections, values_of
from scarid_cli.algorithms.plants import building

EXAMPLES: Values = {
    **LOG_LEVEL,
    "drive-bandwidth": [60.0],
    "motor-gain": [0.05],
    "ripple": [0.1],
    "ripple-cycles": [8.0],
    "stribeck": [0.2, 0.05],
    "stribeck-velocity": [0.2],
    "load-friction": [0.1],
    "friction-asymmetry": [0.2],
    "friction-drift": [-0.3],
    "friction-drift-time": [0.5],
    "flexibility": [15.0],
    "flexibility-damping": [0.1],
    "motor-share": [0.5],
    "encoder-side": ["link"],
    "vibration": [0.5],
    "vibration-frequency": [12.0],
    "vibration-direction": [0.0, 1.0, 0.0],
    "payload": [2.0, 0.1, 0.0, 0.0, 0.01, 0.0, 0.0, 0.01, 0.0, 0.01, 1.0],
    "encoder-bits": [13],
    "encoder-eccentricity": [1e-3],
    "encoder-phase": [0.3],
    "encoder-turns": [30],
    "position-noise": [1e-4],
    "coloured-position-noise": [1e-4],
    "position-noise-time": [0.02],
    "torque-noise": [0.1],
    "sampling-jitter": [4e-4],
    "hidden-jitter": [2e-4],
    "lost-rows": [0.1],
    "standstill-before": [0.123],
    "standstill-after": [0.2],
}


def test_there_is_an_example_of_every_imperfection() -> None:
    assert EXAMPLES.keys() == IMPERFECTIONS.keys()


def chosen(names: set[str]) -> Values:
    """These imperfections, and those that they need."""
    needed = {IMPERFECTIONS[name].NEEDS for name in names} - {""}
    return {name: EXAMPLES[name] for name in EXAMPLES if name in names | needed}


@pytest.mark.parametrize("name", EXAMPLES)
def test_every_imperfection_changes_the_log(name: str) -> None:
    without = chosen({IMPERFECTIONS[name].NEEDS} - {""}) if IMPERFECTIONS[name].NEEDS else {}
    before = {key: value for key, value in without.items() if key != name}
    found, clean = log(values={**before, name: EXAMPLES[name]}), log(values=before)
    changed = found.keys() != clean.keys() or len(found["t"]) != len(clean["t"])
    assert changed or any((found[key] != clean[key]).any() for key in clean)


@given(
    names=st.sets(st.sampled_from(sorted(EXAMPLES))),
    sizes=st.lists(st.sampled_from([1, 2, 7, 64, 8192]), min_size=1, max_size=4),
    rate=st.sampled_from([100.0, 250.0, 1000.0]),
)
@settings(max_examples=len(seeds(8, 15)), deadline=None)
def test_batches_change_no_bit(names: set[str], sizes: list[int], rate: float) -> None:
    values = chosen(names)
    found = collected(simulated(table(references(), sizes), values, rate))
    assert found.equals(collected(simulated(table(references()), values, rate)))


@given(name=st.sampled_from(sorted(LOG_LEVEL)), others=st.sets(st.sampled_from(sorted(LOG_LEVEL))))
@settings(max_examples=30, deadline=None)
def test_a_random_imperfection_does_not_change_the_others(name: str, others: set[str]) -> None:
    """With a value of zero it has no effect, and its random numbers are nobody else's."""
    values = {key: value for key, value in chosen(others).items() if key != name}
    with_zero = {**values, name: [0.0]}
    if name in {IMPERFECTIONS[key].NEEDS for key in values}:
        return
    found, expected = log(values=with_zero), log(values=values)
    for column in expected:
        np.testing.assert_array_equal(found[column], expected[column])


def test_random_streams_are_independent() -> None:
    """Lost rows are the same ones with and without outliers and jitter."""
    alone = log(values={"lost-rows": [0.2]})
    more = {"torque-outliers": [0.5], "torque-outlier-size": [9.0], "coloured-torque-noise": [1.0]}
    together = log(values={"lost-rows": [0.2], "torque-noise-time": [0.1], **more})
    np.testing.assert_array_equal(alone["t"], together["t"])
    np.testing.assert_array_equal(alone["q1"], together["q1"])
    both = simulated(table(references()), {"lost-rows": [0.2]}, 200.0, seed=4)
    assert (
        len(collected(both)) != len(alone["t"])
        or (collected(both).column("t").to_numpy() != alone["t"]).any()
    )


def test_the_logger_keeps_no_more_ticks_than_a_row_can_need() -> None:
    values = {"torque-delay": [0.05], "position-rate": [50.0], "sampling-jitter": [1e-4]}
    given = Imperfections(2, {name: values_of(name, x, 2) for name, x in values.items()})
    loop = closed_loop(given, 0)
    recorder = building.recorder(given, loop, 5)
    state, recording = loop.init(np.zeros(2)), recorder.init(0)
    still = (np.zeros((2, 7)),) * 3
    for _ in range(300):
        state, ticks = loop.step(state, *still)
        recording, _ = recorder.step(recording, ticks, still)
        assert recording.ticks is not None
        assert recording.ticks.shape[2] <= 50 + 20 + 5 + 10
