"""The law of a curve of friction, against curves of a known law; the term that it advises."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT, Shell
from hypothesis import given
from hypothesis import strategies as st

from scarid_cli.algorithms.beyond.curves import REMEDIES, law

SPEEDS = np.linspace(0.05, 2.0, 100)


@given(
    st.floats(0.0, 2.0),
    st.floats(1e-3, 1e3),
    st.sampled_from(
        [(0.3, "slower"), (0.5, "slower"), (1.0, ""), (1.5, "faster"), (2.0, "faster")]
    ),
)
def test_a_power_of_the_speed_is_told(jump: float, size: float, case: tuple[float, str]) -> None:
    power, kind = case
    assert law(SPEEDS, size * (jump + SPEEDS**power)) == REMEDIES[kind]


@given(st.floats(0.1, 0.5), st.floats(0.2, 2.0), st.floats(0.0, 0.1))
def test_a_stribeck_effect_is_told(velocity: float, jump: float, viscous: float) -> None:
    curve = 1.0 + jump * np.exp(-((SPEEDS / velocity) ** 2)) + viscous * SPEEDS
    assert law(SPEEDS, curve) == REMEDIES["falls"]


ARM = """
title = "planar"
urdf = "{urdf}"
[[joint]]
acceleration_limit = 15.0
encoder_resolution = 2e-5
torque_noise = 0.05
terms = {{ inertia = 0.1, viscous = 0.5, coulomb = 1.0, offset = 0.1{quadratic} }}
[[joint]]
acceleration_limit = 20.0
encoder_resolution = 2e-5
torque_noise = 0.02
terms = {{ inertia = 0.02, viscous = 0.2, coulomb = 0.4, offset = 0.0{quadratic} }}
"""


def test_quadratic_friction_is_named_and_its_term_is_what_it_needs(
    shell: Shell, tmp_path: Path
) -> None:
    (tmp_path / "true.toml").write_text(
        ARM.format(urdf=ROOT / "samples" / "arm.urdf", quadratic=", quadratic = 0.4")
    )
    (tmp_path / "known.toml").write_text(
        ARM.format(urdf=ROOT / "samples" / "arm.urdf", quadratic="")
    )
    made = shell(
        "scarid trajgen --robot true.toml --duration 15 --seed 2 | "
        "scarid simulate --robot true.toml --seed 3 -o log.parquet"
    )
    assert made.status == 0, made.err
    named = shell("scarid identify --robot known.toml log.parquet -o p.parquet")
    assert "grows faster than the speed, as its square does" in named.err
    found = shell(
        "scarid identify --robot true.toml log.parquet -o q.parquet && scarid convert q.parquet"
    )
    assert "scarid identify: good: " in found.err
    rows = [line.split(",") for line in found.out.splitlines()]
    at = rows[0].index("estimate")
    values = {row[0]: float(row[at]) for row in rows[1:]}
    assert values["fq1"] == pytest.approx(0.4, rel=0.1)
    assert values["fq2"] == pytest.approx(0.4, rel=0.1)
