"""Exported models, opened by those who read them and compared with what scarid predicts."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import jsonschema
import numpy as np
import pyarrow.parquet as pq
import pytest
from conftest import ROOT, Result
from unit.test_export import robots

from scarid_cli.algorithms.robots.reading import load
from scarid_cli.arrays import Array

mujoco = pytest.importorskip("mujoco")
pinocchio = pytest.importorskip("pinocchio")

Run = Callable[..., Result]
NAMES = ("seven", "level", "telescope")


@pytest.fixture(scope="module")
def models(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with descriptions of several robots."""
    folder = tmp_path_factory.mktemp("models")
    for path in robots(folder).values():
        if path.endswith(".toml"):  # simulators have no such friction
            text = Path(path).read_text()
            text = text.replace("viscous-forward = 0.5, viscous-backward = 0.7", "viscous = 0.6")
            text = text.replace("quadratic = 0.05, ", "")
            if "[[coupling]]" in text:
                text += "[estimates]\nIam2 = 0.02\nfvm2 = 0.1\nfsm2 = 0.3\n"
            Path(path).write_text(text)
    return folder


def identified(scarid: Run, folder: Path, name: str) -> Path:
    """The parameters of a robot, identified from a short log."""
    table = folder / f"{name}.parquet"
    if not table.exists():
        words = ("--robot", folder / f"{name}.toml")
        motion = ("trajgen", "-q", *words, "--duration", 6, "--ddq-max", 10, "--seed", 1)
        log = folder / f"{name}-log.parquet"
        assert scarid(*motion, "then", "simulate", "-q", *words, "-o", log).status == 0
        assert scarid("identify", "-q", *words, log, "-o", table).status == 0
    return table


def sliding(joints: int) -> tuple[Array, Array, Array]:
    """Motions (samples, joints) in which every joint slides."""
    rng = np.random.default_rng(5)
    q, ddq = rng.uniform(-1, 1, (50, joints)), rng.uniform(-3, 3, (50, joints))
    return q, rng.uniform(0.5, 2, (50, joints)) * rng.choice((-1, 1), (50, joints)), ddq


def predicted(folder: Path, name: str, base: Path, q: Array, dq: Array, ddq: Array) -> Array:
    """The torques (samples, joints) of the base parameters of the exported bodies."""
    robot = load(str(folder / f"{name}.toml"))
    values = dict(zip(*(pq.read_table(base)[c].to_pylist() for c in ("parameter", "estimate")),
                      strict=True))  # fmt: skip
    theta = np.array([values[n] for n in robot.names])
    return np.asarray(robot.regressor(*map(np.ascontiguousarray, (q.T, dq.T, ddq.T))) @ theta)


@pytest.mark.parametrize("name", NAMES)
def test_mujoco_needs_the_torques_that_are_predicted(
    name: str, models: Path, tmp_path: Path, scarid: Run
) -> None:
    table, base, path = identified(scarid, models, name), tmp_path / "b.parquet", tmp_path / "a.xml"
    robot = models / f"{name}.toml"
    words = ("export", "--to", "mjcf", "--parameters", table, robot, "--base", base, "-o", path)
    result = scarid(*words)
    assert result.status == 0, result.err
    model = mujoco.MjModel.from_xml_path(str(path))
    off = mujoco.mjtDisableBit.mjDSBL_LIMIT | mujoco.mjtDisableBit.mjDSBL_CONTACT
    model.opt.disableflags |= int(off)
    data, arm = mujoco.MjData(model), load(str(robot))
    assert arm.body
    axes = [model.joint(x).dofadr[0] for x in arm.body.joint_names]
    follows, moving = arm.body.following, [model.joint(x).dofadr[0] for x in arm.body.moving]
    offsets = np.array([model.actuator(x).biasprm[0] for x in arm.body.joint_names])
    motion = sliding(len(axes))
    found = []
    for q, dq, ddq in zip(*motion, strict=True):
        for x, y in ((data.qpos, q), (data.qvel, dq), (data.qacc, ddq)):
            x[axes] = y
            for k in follows.followers:
                along = follows.offset[k] if x is data.qpos else 0.0
                x[moving[k]] = follows.ratio[k] * y[follows.axis[k]] + along
        mujoco.mj_inverse(model, data)
        needed = data.qfrc_inverse[axes].copy()
        for k in follows.followers:
            needed[follows.axis[k]] += follows.ratio[k] * data.qfrc_inverse[moving[k]]
        moment = np.zeros((model.nu, model.nv))
        mujoco.mju_sparse2dense(
            moment, data.actuator_moment, data.moment_rownnz, data.moment_rowadr,
            data.moment_colind,
        )  # fmt: skip
        found.append(needed - moment[:, axes].T @ offsets)
    assert np.array(found) == pytest.approx(predicted(models, name, base, *motion), abs=2e-6)


def test_pinocchio_reads_the_motors_of_the_urdf(models: Path, tmp_path: Path, scarid: Run) -> None:
    """With the armature of its transmissions, its inertia matrix is that of the regressor."""
    table, base, path = (
        identified(scarid, models, "level"),
        tmp_path / "b.parquet",
        tmp_path / "a.urdf",
    )
    robot = models / "level.toml"
    words = ("export", "--to", "urdf", "--parameters", table, robot, "--base", base, "-o", path)
    assert scarid(*words).status == 0
    text = path.read_text()
    inertias = [float(x) for x in re.findall(r'rotor_inertia value="([^"]+)"', text)]
    values = {row["parameter"]: row["estimate"] for row in pq.read_table(base).to_pylist()}
    assert inertias[-1] == pytest.approx(values["Ia2"])
    pinocchio.buildModelFromXML(text)  # reads on past what is not its own


@pytest.mark.parametrize("name", NAMES)
def test_a_toml_file_moves_the_identified_robot(
    name: str, models: Path, tmp_path: Path, scarid: Run
) -> None:
    table, path = identified(scarid, models, name), tmp_path / "own.toml"
    words = ("export", "--to", "toml", "--parameters", table, models / f"{name}.toml", "-o", path)
    assert scarid(*words).status == 0
    values = {row["parameter"]: row["estimate"] for row in pq.read_table(table).to_pylist()}
    found = load(str(path))
    assert {p.name: p.apriori for p in found.parameters} == {n: values[n] for n in found.names}


@pytest.mark.parametrize("kind", ["c", "json"])
def test_what_a_model_lacks_is_told_with_its_remedy(kind: str, tmp_path: Path, scarid: Run) -> None:
    words = ("--robot", "planar2-gravity")
    motion = ("trajgen", "-q", *words, "--seed", 3, "--q-max", "2,2", "--ddq-max", "20,30")
    rubbing = ("then", "simulate", "-q", "--seed", 3, "--with", "load-friction=0.02")
    table = tmp_path / "p.parquet"
    assert scarid(*motion, *rubbing, "then", "identify", "-q", "-o", table).status == 0
    result = scarid("export", "--to", kind, "--parameters", table, *words, "-o", tmp_path / "x")
    assert result.status == 0
    assert (
        f"warning: the {kind} file has the parameters alone, and lacks: friction of joints 1"
        in (result.err)
    )
    assert "grows with the transmitted torque" in result.err


def test_a_typo_among_estimates_is_told(models: Path, tmp_path: Path, scarid: Run) -> None:
    text = (models / "level.toml").read_text().replace("level.urdf", str(models / "level.urdf"))
    (tmp_path / "own.toml").write_text(f"{text}\n[estimates]\nIzz9 = 1.0\n")
    result = scarid("robot", "check", tmp_path / "own.toml")
    assert result.status == 2
    assert "Izz9" in result.err


@pytest.mark.parametrize("name", ["scara2", *NAMES])
def test_the_document_is_as_its_schema_says(
    name: str, models: Path, tmp_path: Path, scarid: Run
) -> None:
    if name == "scara2":
        table, robot = ROOT / "samples/scara2.parameters.csv", name
    else:
        table, robot = identified(scarid, models, name), str(models / f"{name}.toml")
    result = scarid("export", "--to", "json", "--parameters", table, robot)
    assert result.status == 0, result.err
    found = json.loads(result.out)
    schema = json.loads((ROOT / "schemas/documents/export.schema.json").read_text("utf-8"))
    jsonschema.Draft202012Validator.check_schema(schema)
    jsonschema.validate(found, schema)
    told = [x for part in (*found["links"], *found["axes"]) for x in part["parameters"]]
    assert {x["parameter"] for x in told} == set(load(robot).names)


@pytest.mark.skipif(not shutil.which("octave"), reason="no Octave here")
@pytest.mark.parametrize("name", NAMES)
def test_octave_has_the_torques_of_the_regressor(
    name: str, models: Path, tmp_path: Path, scarid: Run
) -> None:
    table = identified(scarid, models, name)
    words = ("export", "--to", "matlab", "--parameters", table, models / f"{name}.toml")
    assert scarid(*words, "--name", "arm", "-o", tmp_path / "arm.m").status == 0
    motion = sliding(len(load(str(models / f"{name}.toml")).joints))
    for key, x in zip(("q", "dq", "ddq"), motion, strict=True):
        np.savetxt(tmp_path / f"{key}.txt", x)
    program = (
        "q = load('q.txt'); dq = load('dq.txt'); ddq = load('ddq.txt'); for k = 1:rows(q)\n"
        "printf('%.17g ', arm.inverse_dynamics(q(k, :), dq(k, :), ddq(k, :))); printf(\"\\n\"); end"
    )
    done = subprocess.run(
        ["octave", "-qf", "--eval", program],
        cwd=tmp_path,
        check=True,
        capture_output=True,
        text=True,
    )
    found = np.array([line.split() for line in done.stdout.splitlines()], dtype=float)
    assert found == pytest.approx(predicted(models, name, table, *motion), rel=1e-9, abs=1e-9)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--to", "mjcf", "scara2"), "has no URDF"),
        (("--to", "c", "--base", "b.csv", "scara2"), "--base: c has no bodies"),
        (("--robot", "scara2", "scara2"), "given twice"),
    ],
)
def test_what_cannot_be_written_is_refused(
    words: tuple[str, ...], told: str, tmp_path: Path, scarid: Run
) -> None:
    table = ROOT / "samples/scara2.parameters.csv"
    result = scarid("export", "--parameters", table, *words, "-o", tmp_path / "out")
    assert result.status == 2
    assert told in result.err
    assert not (tmp_path / "out").exists()
