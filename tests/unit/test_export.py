"""The exported C, compiled and compared with the regressor and with Pinocchio's mass matrix."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from conftest import Shell
from unit.arms import seven_axes
from unit.test_following import LEVEL, TELESCOPE, urdf

from scarid_cli.algorithms.plants.model import inertia, model
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.arrays import Array
from scarid_cli.stages.export import c_header
from scarid_cli.stages.results.parameters import Identified

pytestmark = pytest.mark.skipif(not shutil.which("cc"), reason="no C compiler here")
TERMS = (
    "inertia = 0.2, viscous-forward = 0.5, viscous-backward = 0.7, coulomb-forward = 0.6, "
    "coulomb-backward = 0.8, quadratic = 0.05, offset = 0.1"
)
PRISMATIC = "\n[[coupling]]\njoints = [1, 2]\nratio = 3.0\n"


def robots(folder: Path) -> dict[str, str]:
    """Robots of all kinds, as files or names."""
    found = {"scara2": "scara2", "planar2-gravity": "planar2-gravity"}
    for name, text, joints in (
        ("seven", seven_axes(), [f"j{i}" for i in range(1, 8)]),
        ("level", urdf(LEVEL), ["j1", "j2"]),
        ("telescope", urdf(TELESCOPE), ["j1", "j2"]),
    ):
        (folder / f"{name}.urdf").write_text(text)
        axes = "".join(f'[[joint]]\nname = "{j}"\nterms = {{ {TERMS} }}\n' for j in joints)
        coupling = PRISMATIC if name == "seven" else ""
        description = f'title = "{name}"\nurdf = "{name}.urdf"\n{axes}{coupling}'
        (folder / f"{name}.toml").write_text(description)
        found[name] = str(folder / f"{name}.toml")
    return found


CALLS = """
#include "robot.h"
void dynamics(double *q, double *dq, double *ddq, double *tau)
{ robot_inverse_dynamics(q, dq, ddq, tau); }
void gravity(double *q, double *tau) { robot_gravity(q, tau); }
void mass(double *q, double *M) { robot_mass_matrix(q, M); }
void rub(double *dq, double *tau) { robot_friction(dq, tau); }
"""


def compiled(robot: Robot, theta: Array, folder: Path) -> ctypes.CDLL:
    header = c_header(
        Identified(robot, theta, 0.0, low_pass=False, additions=()), "robot", "a test"
    )
    (folder / "robot.h").write_text(header)
    (folder / "calls.c").write_text(CALLS)
    flags = ["-std=c99", "-O2", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC"]
    subprocess.run(["cc", *flags, "calls.c", "-o", "calls.so", "-lm"], cwd=folder, check=True)
    return ctypes.CDLL(str(folder / "calls.so"))


def pointer(x: Array) -> ctypes.c_void_p:
    return ctypes.c_void_p(x.ctypes.data)


@pytest.mark.parametrize("name", ["scara2", "planar2-gravity", "seven", "level", "telescope"])
def test_the_torques_are_those_of_the_regressor(name: str, tmp_path: Path) -> None:
    """With estimates that no rigid bodies have, as real ones are."""
    robot = load(robots(tmp_path)[name])
    rng = np.random.default_rng(7)
    theta = robot.apriori * rng.uniform(0.5, 1.5, len(robot.parameters))
    theta += 0.01 * rng.standard_normal(len(theta))
    library, n = compiled(robot, theta, tmp_path), len(robot.joints)
    for _ in range(50):
        motion = rng.uniform(-3.0, 3.0, (3, n))
        q, dq, ddq = (x[:, None] for x in motion)
        tau, still = np.empty(n), np.empty(n)
        library.dynamics(*map(pointer, np.ascontiguousarray(motion)), pointer(tau))
        wanted = robot.regressor(q, dq, ddq)[0] @ theta
        np.testing.assert_allclose(tau, wanted, rtol=1e-9, atol=1e-9)
        zero = 0.0 * q
        weight = robot.regressor(q, zero, zero)[0] @ theta
        library.rub(pointer(0.0 * motion[1]), pointer(still))  # the offsets
        library.gravity(pointer(motion[0]), pointer(tau))
        np.testing.assert_allclose(tau + still, weight, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("name", ["seven", "level"])
def test_the_mass_matrix_is_that_of_the_simulator(name: str, tmp_path: Path) -> None:
    robot = load(robots(tmp_path)[name])
    library, n = compiled(robot, robot.apriori, tmp_path), len(robot.joints)
    q, M = np.random.default_rng(1).uniform(-2.0, 2.0, n), np.empty((n, n))
    library.mass(pointer(q), pointer(M))
    np.testing.assert_allclose(M, inertia(model(robot), q), rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(M, M.T, rtol=1e-12, atol=1e-12)


def test_the_command_writes_what_compiles(shell: Shell, tmp_path: Path) -> None:
    done = shell(
        "scarid identify -q --robot scara2 $SAMPLES/scara2.csv -o p.parquet;"
        " scarid export --parameters p.parquet --name my-arm -o arm.h;"
        ' printf \'#include "arm.h"\\nint main(void) { double q[2] = {0}, tau[2];'
        " my_arm_gravity(q, tau); return tau[0] != 0.0; }\\n' > main.c;"
        " cc -std=c99 -Wall -Wextra -Werror main.c -o main -lm && ./main"
    )
    assert done.status == 0, done.err
    text = (tmp_path / "arm.h").read_text()
    assert text.startswith("/* scarid export --parameters p.parquet --name my-arm")
    assert "my_arm_inverse_dynamics" in text
