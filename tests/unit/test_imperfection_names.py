"""The registry of imperfections: what each states about itself, and what values it takes."""

from __future__ import annotations

from math import isfinite

import pytest

from scarid_cli.algorithms.imperfections.registry import (
    IMPERFECTIONS,
    PLACES,
    Imperfections,
    declared_in,
    imperfections_of,
    values_of,
)
from scarid_cli.algorithms.imperfections.torques import TorqueDelay

every_imperfection = pytest.mark.parametrize("name", IMPERFECTIONS)


def test_every_imperfection_has_a_name_and_a_place_of_its_own() -> None:
    placed = [kind for place in PLACES for kind in declared_in(place)]
    assert all(declared_in(place) for place in PLACES)
    assert [kind.NAME for kind in placed] == list(IMPERFECTIONS)
    assert len(set(placed)) == len(placed)


@every_imperfection
def test_an_imperfection_is_described_in_one_line_and_in_its_own_words(name: str) -> None:
    kind = IMPERFECTIONS[name]
    first = (kind.__doc__ or "").splitlines()[0]
    assert "__doc__" in vars(kind)
    assert first.endswith(".")
    assert first[0].isupper()


@every_imperfection
def test_its_default_is_a_value_that_it_takes(name: str) -> None:
    kind = IMPERFECTIONS[name]
    values = Imperfections(2).of(kind)
    assert len(values) == (2 if kind.PER_JOINT else len(kind.NUMBERS))
    if not kind.NUMBERS[0].words:
        assert values_of(name, values, 2) == values


@every_imperfection
def test_what_it_needs_is_another_imperfection(name: str) -> None:
    needed = IMPERFECTIONS[name].NEEDS
    assert not needed or needed in IMPERFECTIONS.keys() - {name}
    if needed:
        given = {name: Imperfections(2).of(IMPERFECTIONS[name])}
        with pytest.raises(ValueError, match=f"{name} has no effect without {needed}; give both"):
            Imperfections(2, given).check()


@every_imperfection
@pytest.mark.parametrize("value", ["nan", "inf", "-inf", "1e999", "", "one", True, None, []])
def test_what_is_not_a_finite_number_is_refused(name: str, value: object) -> None:
    count = len(IMPERFECTIONS[name].NUMBERS)
    with pytest.raises(ValueError, match=r"not a number|not a finite number|none of its words"):
        values_of(name, [value] * count, 2)


@every_imperfection
def test_what_is_outside_its_range_is_refused(name: str) -> None:
    kind = IMPERFECTIONS[name]
    for place, number in enumerate(kind.NUMBERS):
        for end in (number.low - 1.0, number.high + 1.0):
            values: list[object] = list(Imperfections(1).of(kind))
            values[place] = end
            if isfinite(end) and not number.words:
                with pytest.raises(ValueError, match="is outside its range; give"):
                    values_of(name, values, 1)


@pytest.mark.parametrize(
    ("name", "values", "complaint"),
    [
        ("torque-delay", [1, 2, 3], "3 values; give one for all joints, or one for each of 2 jo"),
        ("torque-delay", [], "0 values; give one for all joints"),
        ("lost-rows", [0.1, 0.1], "2 values; give one$"),
        ("lost-rows", [0.95], "0.95 is outside its range; give a number from 0 to 0.9$"),
        ("torque-delay", ["-1"], "-1 is outside its range; give 0 s or more$"),
        ("encoder-bits", [12.5], "12.5 is not a whole number"),
        ("torque-dely", [1], "there is no imperfection 'torque-dely'; did you mean torque-delay"),
        ("humour", [1], "there is no imperfection 'humour'; scarid simulate --help lists all"),
    ],
)
def test_a_mistake_is_said_in_one_line(name: str, values: list[object], complaint: str) -> None:
    with pytest.raises(ValueError, match=complaint):
        values_of(name, values, 2)


def test_one_value_is_for_all_joints() -> None:
    assert values_of("torque-delay", ["0.002"], 3) == (0.002,) * 3
    assert values_of("torque-delay", [1, 2, 3], 3) == (1.0, 2.0, 3.0)


def test_a_description_gives_numbers_or_lists() -> None:
    found = imperfections_of({"imperfections": {"torque-delay": [0.1, 0.2], "lost-rows": 0.5}}, 2)
    assert found == {"torque-delay": (0.1, 0.2), "lost-rows": (0.5,)}
    assert Imperfections(2, found).of(TorqueDelay) == (0.1, 0.2)
    assert imperfections_of({}, 2) == {}


@pytest.mark.parametrize(
    ("entry", "complaint"),
    [
        ({"torque-delay": -1}, r"\[imperfections\] torque-delay: -1 is outside its range"),
        ({"torque-delay": {}}, r"\[imperfections\] torque-delay: {} is not a number"),
        ({"humour": 1}, r"\[imperfections\] humour: there is no imperfection 'humour'"),
    ],
)
def test_a_mistake_in_a_description_is_named(entry: dict[str, object], complaint: str) -> None:
    with pytest.raises(ValueError, match=complaint):
        imperfections_of({"imperfections": entry}, 2)
