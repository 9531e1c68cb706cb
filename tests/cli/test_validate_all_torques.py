"""What changes all torques at once is called by its name by `scarid validate`."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT, Result

Run = Callable[..., Result]

UR10E = ROOT / "samples" / "robots"


def verdict(result: Result) -> str:
    found = re.search(r"^scarid validate: (changed|unchanged|unexplained): (.*)$", result.err, re.M)
    assert found, result.err
    return f"{found[1]}: {found[2]}"


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ("torque-constant-error=0.05,0.05", r"scale of all torques \(torques \+(4\.9|5\.[01])"),
        ("torque-delay=0.015", r"another delay \(torques 1[56]\.?\d* \+- 0\.\d+ ms later"),
        # Of first order, 1 / (2 pi 10 Hz) = 15.9 ms.
        ("torque-bandwidth=10", r"another low-pass of the torques \(torques lag by 1[567]"),
    ],
)
def test_one_cause_of_all_torques_is_named(change: str, named: str, shell: Run) -> None:
    made = shell(
        "scarid trajgen -q --seed 1 | scarid simulate -q --seed 1 --format arrow |"
        " scarid identify -q -o before.parquet; scarid trajgen -q --seed 2 |"
        f" scarid simulate -q --seed 2 --with {change} --format arrow |"
        " scarid validate --parameters before.parquet"
    )
    assert re.match(rf"changed: {named}.*\); this explains (9\d|100)", verdict(made)), made.err


def test_a_base_that_is_tilted_since_is_named(tmp_path: Path, scarid: Run) -> None:
    """It is no other zero of a joint, nor another payload."""
    pytest.importorskip("pinocchio")
    upright, tilted = UR10E / "ur10e.toml", tmp_path / "tilted.toml"
    description = upright.read_text("utf-8").replace('"ur10e.urdf"', f'"{UR10E / "ur10e.urdf"}"')
    angle = np.deg2rad(2.0)
    gravity = -9.81 * np.array([np.sin(angle), 0.0, np.cos(angle)])
    tilted.write_text(f"gravity = {gravity.tolist()}\n{description}")
    reference, log, before = (tmp_path / f"{name}.parquet" for name in ("r", "log", "before"))
    for robot, seed in ((upright, "1"), (tilted, "2")):
        made = (
            scarid("trajgen", "--robot", robot, "--seed", seed, "-o", reference),
            scarid("simulate", "--robot", robot, "--seed", seed, reference, "-o", log),
        )
        if robot == upright:
            made += (scarid("identify", "--robot", upright, log, "-o", before),)
        assert all(result.status == 0 for result in made), made
    found = verdict(scarid("validate", "--robot", upright, "--parameters", before, log))
    assert found.startswith("changed: gravity in another direction, as on a tilted base (by ")
    stated = re.search(r"by (.*?) \+- .* degrees", found)
    assert stated
    assert float(stated[1]) == pytest.approx(2.0, abs=0.3)
