"""What a call of the exported C file costs, beside Pinocchio's C++ and Python.

    python benchmarks/exported.py [--calls 300000] [--eigen INCLUDE]

The UR10e of `samples/robots` is identified from a simulated log and exported to C and to URDF,
which are asked for the same random motions: microseconds of a call, the median of nine runs that
take turns. The C file has friction as well. The C++ is compiled against the headers of the `pin`
wheel, in two minutes; those of Eigen are not there, but in `pip install cmeel-eigen`. That both
have the same torques is the matter of `tests/cli/test_export.py`.
"""

from __future__ import annotations

import argparse
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

SCARID = Path(sys.executable).parent / "scarid"
ARM = Path(__file__).parent.parent / "samples" / "robots" / "ur10e.toml"
MOTIONS, RUNS = 1000, 9
# What Pinocchio's own build states for the lists of its joints.
LIMITS = [
    "-DBOOST_FUSION_INVOKE_MAX_ARITY=12",
    "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS",
    "-DBOOST_MPL_LIMIT_LIST_SIZE=30",
]
MAIN = """
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
enum {{ N = {axes}, MOTIONS = {motions} }};
static double q[MOTIONS][N], dq[MOTIONS][N], ddq[MOTIONS][N], out[N * N];
static double seconds(void) {{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return t.tv_sec + 1e-9 * t.tv_nsec;
}}
int main(int count, char **words) {{
    FILE *f = fopen(words[1], "rb");
    size_t read = fread(q, sizeof q, 1, f) + fread(dq, sizeof q, 1, f) + fread(ddq, sizeof q, 1, f);
    if (read != 3) return 1;
    long calls = atol(words[2]);
    {setup}
    double sum = 0.0, start;
    {tests}
    return sum == 0.5;  // so that no call is left out
}}
"""
TEST = """
    start = seconds();
    for (long n = 0; n < calls; n++) {{ int k = n % MOTIONS; {call} sum += out[0]; }}
    printf("%s %.6g\\n", "{name}", 1e6 * (seconds() - start) / calls);
"""
C = {
    "inverse dynamics": "ur10e_inverse_dynamics(q[k], dq[k], ddq[k], out);",
    "gravity": "ur10e_gravity(q[k], out);",
    "mass matrix": "ur10e_mass_matrix(q[k], out);",
}
MAP = "Eigen::Map<const Eigen::VectorXd>({}[k], N)"
Q, DQ, DDQ = (MAP.format(name) for name in ("q", "dq", "ddq"))
OUT, SQUARE = "Eigen::Map<Eigen::VectorXd>(out, N)", "Eigen::Map<Eigen::MatrixXd>(out, N, N)"
CPP = {
    "inverse dynamics": f"{OUT} = pinocchio::rnea(model, data, {Q}, {DQ}, {DDQ});",
    "gravity": f"{OUT} = pinocchio::computeGeneralizedGravity(model, data, {Q});",
    "mass matrix": f"{SQUARE} = pinocchio::crba(model, data, {Q}, pinocchio::Convention::WORLD);",
}
HEADERS = """#include <pinocchio/serialization.hpp>
#include <pinocchio/multibody.hpp>
#include <pinocchio/algorithm/joint-configuration.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/algorithm/crba.hpp>
"""


def shell(*words: object) -> str:
    done = subprocess.run([*map(str, words)], capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"{words[0]}: {done.stderr[-1000:]}")
    return done.stdout


def source(include: str, calls: dict[str, str], setup: str, axes: int) -> str:
    tests = "".join(TEST.format(name=name, call=call) for name, call in calls.items())
    return include + MAIN.format(axes=axes, motions=MOTIONS, setup=setup, tests=tests)


def exported(folder: Path) -> None:
    """The arm, identified from a simulated log, as C and as a URDF without friction."""
    shell("sh", "-c", f"{SCARID} trajgen -q --robot {ARM} --seed 1 | {SCARID} simulate -q -o"
          f" {folder}/log.parquet --robot {ARM} && {SCARID} identify -q --robot {ARM}"
          f" {folder}/log.parquet -o {folder}/p.parquet")  # fmt: skip
    words = ("--parameters", folder / "p.parquet", ARM)
    shell(SCARID, "export", "-q", "--to", "c", "--name", "ur10e", *words, "-o", folder / "ur10e.h")
    shell(SCARID, "export", "-q", "--to", "urdf", *words, "-o", folder / "ur10e.urdf")


def timed(command: list[str], folder: Path, calls: int) -> dict[str, float]:
    """Microseconds of a call, by what is called."""
    lines = shell(*command, folder / "motion.bin", calls).splitlines()
    return {name: float(time) for name, time in (line.rsplit(" ", 1) for line in lines)}


def by_python(folder: Path, motion: np.ndarray, calls: int) -> dict[str, float]:
    """Pinocchio's calls from Python, with what the passage costs."""
    import pinocchio as pin

    model = pin.buildModelFromUrdf(str(folder / "ur10e.urdf"))
    data, found = model.createData(), {}
    called = {
        "inverse dynamics": lambda k: pin.rnea(model, data, *motion[:, k]),
        "gravity": lambda k: pin.computeGeneralizedGravity(model, data, motion[0, k]),
        "mass matrix": lambda k: pin.crba(model, data, motion[0, k]),
    }
    for name, call in called.items():
        start = time.process_time()
        for n in range(calls):
            call(n % MOTIONS)
        found[name] = 1e6 * (time.process_time() - start) / calls
    return found


def compiled(folder: Path, eigen: str | None, axes: int) -> dict[str, list[str]]:
    """The programs, by their names."""
    (folder / "own.c").write_text(source('#include "ur10e.h"\n', C, "", axes))
    shell("gcc", "-std=gnu99", "-O2", "-o", folder / "own", folder / "own.c", "-lm")
    programs = {"scarid, C": [str(folder / "own")]}
    if eigen:
        import pinocchio

        prefix = Path(pinocchio.__file__).parents[4]
        pinocchio.buildModelFromUrdf(str(folder / "ur10e.urdf")).saveToText(str(folder / "model"))
        setup = f'pinocchio::Model model; model.loadFromText("{folder}/model");'
        setup += " pinocchio::Data data(model);"
        (folder / "peer.cpp").write_text(source(HEADERS, CPP, setup, axes))
        where = [f"-I{prefix}/include", f"-I{eigen}", f"-L{prefix}/lib", f"-Wl,-rpath,{prefix}/lib"]
        shell("g++", "-std=c++17", "-O2", "-DNDEBUG", "-w", *LIMITS, *where, "-o", folder / "peer",
              folder / "peer.cpp", "-lpinocchio_default", "-lboost_serialization")  # fmt: skip
        programs["Pinocchio, C++"] = [str(folder / "peer")]
    return programs


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--calls", type=int, default=300_000)
    parser.add_argument("--eigen", help="folder of Eigen's headers; without it no C++")
    given = parser.parse_args()
    rng = np.random.default_rng(1)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        exported(folder)
        motion = rng.uniform(-1.0, 1.0, (3, MOTIONS, 6))
        motion.tofile(folder / "motion.bin")
        programs = compiled(folder, given.eigen, motion.shape[2])
        times: dict[str, list[dict[str, float]]] = {}
        for _ in range(RUNS):
            for program, command in programs.items():
                times.setdefault(program, []).append(timed(command, folder, given.calls))
            python = by_python(folder, motion, given.calls // 10)
            times.setdefault("Pinocchio, Python", []).append(python)
    print(f"{'us per call':<20}", *(f"{name:>18}" for name in C))
    for program, runs in times.items():
        cells = (statistics.median(run[name] for run in runs) for name in C)
        print(f"{program:<20}", *(f"{cell:>18.3g}" for cell in cells))


if __name__ == "__main__":
    main()
