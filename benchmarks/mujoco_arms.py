"""The blind procedure on arms that another simulator moves: MuJoCo.

    python benchmarks/mujoco_arms.py --seeds 5

Each arm of `arms.py`, with the same motors and friction, follows a random trajectory in MuJoCo: an
implicit integrator with steps of half a millisecond, the inertia of the motors as armature, and
Coulomb friction as a constraint, which creeps where ours holds. A thousand times a second a PD law
asks for an acceleration, which the inertia at the start turns into torques, beside the exact ones
of gravity and velocity. The log has encoders, and torques with noise, at 250 Hz. It is identified
as `scarid identify --robot ARM LOG` does. The columns are the error of the predicted torque
(gauntlet.py), the root mean square of the errors of the estimates over the stated ones, the 95 %
intervals that contain the true value, the logs that are graded good, and those that are, although
an estimate is off by too many errors.
"""

from __future__ import annotations

import argparse
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path
from xml.etree import ElementTree

import mujoco
import numpy as np
import pyarrow as pa
from arms import ACCELERATION, ARMS, INERTIA, URDFS
from conditions import Condition, robot_named, trajectory
from gauntlet import Judged, judged

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array
from scarid_cli.io.table import Metadata, Table, doubles, matrix

STEP, CONTROL, LOG = 5e-4, 2, 8  # s; steps per period of the controller and of the log
BANDWIDTH, DAMPING = 2.0 * np.pi * 4.0, 0.7  # of the controller [rad/s]
SHARES = ("inside", "good", "wrong")
STIFFNESS, SHARE = (-1.0, -1.0 / STEP), 0.999  # of the constraint: friction is full above some mm/s


def stripped(urdf: Path, axes: list[str]) -> str:
    """The URDF without meshes, and with all joints fixed that are no axes."""
    root = ElementTree.parse(urdf).getroot()
    for link in root.findall("link"):
        for shape in [*link.findall("visual"), *link.findall("collision")]:
            link.remove(shape)
    for joint in root.findall("joint"):
        if joint.get("name") not in axes:
            joint.set("type", "fixed")
        for part in [*joint.findall("mimic"), *joint.findall("dynamics")]:
            joint.remove(part)
    extension = ElementTree.SubElement(root, "mujoco")
    settings = {"fusestatic": "true", "balanceinertia": "false", "inertiafromgeom": "false"}
    ElementTree.SubElement(extension, "compiler", settings)
    return ElementTree.tostring(root, encoding="unicode")


def model_of(name: str, robot: Robot) -> mujoco.MjModel:
    """The arm in MuJoCo, from its URDF: joints that the robot does not have are fixed."""
    assert robot.body
    text = stripped(URDFS / f"{name}.urdf", robot.body.joint_names)
    model = mujoco.MjModel.from_xml_string(text)
    model.opt.timestep, model.opt.integrator = STEP, mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    joints = range(1, len(robot.joints) + 1)
    model.dof_armature[:] = [joint.torque_limit * INERTIA / ACCELERATION for joint in robot.joints]
    model.dof_damping[:] = [robot.value("viscous", i) for i in joints]
    model.dof_frictionloss[:] = [robot.value("coulomb", i) for i in joints]
    model.dof_solref[:], model.dof_solimp[:, :2] = STIFFNESS, SHARE
    model.jnt_limited[:] = 0  # a stop would push the joint back
    return model


def moved(name: str, robot: Robot, seed: int) -> Table:
    """The log of a random motion in MuJoCo."""
    (planned,) = pa.Table.from_batches(
        list(trajectory(robot, seed, Condition("MuJoCo")).batches)
    ).combine_chunks().to_batches()  # fmt: skip
    joints = [str(i) for i in range(1, len(robot.joints) + 1)]
    t = matrix(planned, ["t"])[0]
    q, dq = (matrix(planned, [f"{s}{i}_ref" for i in joints]) for s in ("q", "dq"))
    model = model_of(name, robot)
    data = mujoco.MjData(model)
    data.qpos[:] = q[:, 0]
    mujoco.mj_forward(model, data)
    inertia = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, inertia)
    rows = []
    for step in range(int(t[-1] / STEP)):
        if step % CONTROL == 0:
            at = step * STEP
            behind, slower = ([np.interp(at, t, x) for x in y] for y in (q, dq))
            wanted = BANDWIDTH**2 * (behind - data.qpos)
            wanted += 2.0 * DAMPING * BANDWIDTH * (slower - data.qvel)
            data.qfrc_applied[:] = np.diag(inertia) * wanted + data.qfrc_bias
        if step % LOG == 0:
            rows.append([step * STEP, *data.qpos, *data.qfrc_applied])
        mujoco.mj_step(model, data)
    return logged(robot, np.array(rows).T, np.random.default_rng(seed))


def logged(robot: Robot, rows: Array, rng: np.random.Generator) -> Table:
    """Time, positions and torques (1 + 2 joints, samples) as encoders and sensors show them."""
    names = ["t", *(f"{s}{i + 1}" for s in ("q", "tau") for i in range(len(robot.joints)))]
    for i, joint in enumerate(robot.joints):
        resolution = joint.encoder_resolution
        rows[1 + i] = resolution * np.round(rows[1 + i] / resolution)
        rows[1 + len(robot.joints) + i] += joint.torque_noise * rng.standard_normal(rows.shape[1])
    batch = pa.RecordBatch.from_arrays([doubles(x) for x in rows], names=names)
    meta = Metadata(kind="measurement", robot=robot.name, period=LOG * STEP)
    return Table("MuJoCo", batch.schema, meta, [batch])  # type: ignore[arg-type]


def result(name: str, seed: int) -> Judged:
    """What the blind procedure finds in one log."""
    robot = robot_named(name)
    return judged(name, robot.apriori, moved(name, robot, seed), seed)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=5, help="number of logs of each arm")
    seeds = range(30_000, 30_000 + parser.parse_args().seeds)
    print("| arm | parameters | torque off by [%] | rms | coverage | good | wrong |")
    print("|---|---|---|---|---|---|---|")
    with ProcessPoolExecutor(2) as pool:
        for name in ARMS:
            found = list(pool.map(partial(result, name), seeds))
            off = np.concatenate([one.off for one in found])
            shares = [np.mean([getattr(x, what) for x in found]) for what in SHARES]
            figures = [
                f"{len(found[0].off)}",
                f"{100.0 * np.median([one.torque for one in found]):.2g}",
                f"{np.sqrt(np.mean(off**2)):.2f}",
                *(f"{100.0 * share:.0f}" for share in shares),
            ]
            print(f"| {name} | {' | '.join(figures)} |", flush=True)


if __name__ == "__main__":
    main()
