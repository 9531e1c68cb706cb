"""Units that names of columns state, against their definitions in the literature."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scarid_cli.stages.conversion.recorders import unit_in_name, unstated_unit
from scarid_cli.stages.conversion.units import UNITS, known_unit, scale_of

# NIST SP 811 (2008), Guide for the Use of the International System of Units.
PUBLISHED = {
    "ft-lb": 1.355818, "lbf·ft": 1.355818, "ft lbf": 1.355818, "lb-ft": 1.355818,
    "in-lb": 0.1129848, "lbf.in": 0.1129848, "oz-in": 7.061552e-3, "ozf in": 7.061552e-3,
    "kgf cm": 0.0980665, "kgf·cm": 0.0980665, "kg-cm": 0.0980665, "kgf m": 9.80665,
    "Ncm": 0.01, "N·cm": 0.01, "Nm": 1.0, "N-m": 1.0, "N.m": 1.0,
}  # fmt: skip


@pytest.mark.parametrize("text", PUBLISHED)
@pytest.mark.parametrize("form", ["torque1 [{}]", "torque1 ({})", "torque1_{}"])
def test_a_torque_is_read_in_the_unit_that_its_column_states(text: str, form: str) -> None:
    found = unit_in_name(form.format(text))
    assert found
    assert found[0] == "torque1"
    scale = scale_of(found[1])
    assert scale
    assert scale[0] == pytest.approx(PUBLISHED[text], rel=1e-6)
    assert scale[1] == "N m"


@given(st.sampled_from(sorted(UNITS)), st.floats(1e-6, 1e6))
def test_a_factor_multiplies_what_one_unit_is(unit: str, factor: float) -> None:
    one, some = scale_of(unit), scale_of(f"{factor!r} {unit}")
    assert one
    assert some
    assert some[1] == one[1]
    assert math.isclose(some[0], factor * one[0], rel_tol=1e-12)


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("Axis1 Torque [%]", "%"),
        ("torque1 [pu]", "pu"),
        ("torque_p.u.", "p.u."),
        ("Torque 1 [V]", "V"),
        ("pos_counts", "counts"),
        ("actual_q[0]", ""),
        ("torque1 [Nm]", ""),
        ("state.q[3]", ""),
        ("Position [joint 1]", ""),
        ("position_raw", ""),
    ],
)
def test_a_unit_that_only_the_device_knows_is_none_of_ours(name: str, unit: str) -> None:
    assert unstated_unit(name) == unit
    assert known_unit(unit) is None
