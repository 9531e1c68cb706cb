"""Mass matrices that no robot has, against Pinocchio's."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from conftest import Shell
from unit.arms import seven_axes

from scarid_cli.algorithms.plants.definite import indefinite, random_postures
from scarid_cli.algorithms.robots.reading import load

pinocchio = pytest.importorskip("pinocchio")
AXES = 3


@pytest.mark.parametrize("factor", [1.0, -0.5])
def test_the_posture_and_the_eigenvalue_are_those_of_the_mass_matrix(
    tmp_path: Path, factor: float
) -> None:
    """The inertia of the last link times a factor: a negative one is impossible somewhere."""
    path = tmp_path / "arm.urdf"
    path.write_text(seven_axes(axes=AXES))
    robot = load(str(path))
    values = dict(zip(robot.names, robot.apriori.tolist(), strict=True))
    name = next(x for x in robot.names if x.startswith(f"Izz{AXES}"))
    values[name] *= factor
    found = indefinite(robot.with_values(values))
    if factor > 0.0:
        assert found is None
        return
    assert found
    model = pinocchio.buildModelFromUrdf(str(path))
    data = model.createData()
    changed = values[name] * (1.0 - 1.0 / factor)

    def least(q: np.ndarray) -> float:
        M = pinocchio.crba(model, data, q).copy()
        M = np.triu(M) + np.triu(M, 1).T
        J = pinocchio.computeJointJacobian(model, data, q, AXES)[5]
        return float(np.linalg.eigvalsh(M + changed * np.outer(J, J))[0])

    values_of = [least(q) for q in random_postures(robot, 1000)]
    assert found.least == pytest.approx(min(values_of), rel=1e-6)
    assert found.number == np.count_nonzero(np.array(values_of) < 0.0)
    assert least(found.q) == pytest.approx(found.least, rel=1e-6)


def test_code_of_an_impossible_robot_says_so(shell: Shell) -> None:
    made = shell(
        "scarid trajgen -q --robot scara2 --duration 5 | scarid simulate -q --robot scara2 |"
        " scarid identify -q --robot scara2 | sed 's/^ZZ2,kg m2,[^,]*/ZZ2,kg m2,-0.5/' > p.csv;"
        " scarid export --robot scara2 --parameters p.csv -o arm.h; grep -c 'not positive' arm.h"
    )
    assert made.out == "1\n", made.err
    assert "warning: the mass matrix is not positive definite in 1000 of 1000 random" in made.err
