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
