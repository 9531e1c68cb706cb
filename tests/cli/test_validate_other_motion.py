"""An unchanged robot is unchanged on another kind of motion than that of its identification."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from conftest import Result

Run = Callable[..., Result]


@pytest.mark.parametrize(("first", "second"), [("fourier", "quintic"), ("sequential", "fourier")])
def test_another_motion_is_no_change(first: str, second: str, shell: Run) -> None:
    """Fourier series reverse slowly, so that their torques ring more behind the low-pass."""
    for number, kind in enumerate((first, second), start=1):
        made = shell(
            f"scarid trajgen -q --excitation {kind} --seed {number} --duration 30 |"
            f" scarid simulate -q --seed {number} -o {number}.parquet"
        )
        assert made.status == 0, made.err
    shell("scarid identify -q 1.parquet -o parameters.parquet")
    found = shell("scarid validate --parameters parameters.parquet 2.parquet")
    assert "scarid validate: unchanged: residual " in found.err


def test_an_identification_without_slow_rows_is_not_changed_by_its_own_log(shell: Run) -> None:
    """The slow rows, whose friction no parameter describes, are in the metrics alone."""
    made = shell(
        "export SCARID_ROBOT=scara2; scarid trajgen -q --seed 1 --duration 10 |"
        " scarid simulate -q --seed 1 --with stribeck=0.5 --with stribeck-velocity=0.1 |"
        " scarid differentiate -q --method kalman -o motion.parquet;"
        " scarid identify -q --estimator wls --all-rows --drop-slow .3 motion.parquet -o p.parquet;"
        " scarid validate -q --all-rows --parameters p.parquet --require unchanged motion.parquet"
    )
    assert made.status == 0, made.err
    assert made.out.count("\n") == 3
