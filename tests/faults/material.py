"""The undamaged files that faults are put into, made by scarid itself."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from faults.trials import Trial, ended, folder_of, removed

SAMPLES = Path(__file__).parents[2] / "samples"
ENDINGS = ("csv", "parquet", "arrows", "arrow")
ROBOT = "robot.toml"


def made(folder: Path, *words: str) -> None:
    """Run a command that must succeed."""
    done = ended(Trial("preparation", words, folder))
    if done.status:
        raise RuntimeError(f"scarid {' '.join(words)}: {done.error}")


@cache
def files() -> dict[str, bytes]:
    """The contents by name: a short log and its motion in each format, and what goes with them."""
    log = (SAMPLES / "scara2.csv").read_bytes().splitlines(keepends=True)
    folder = folder_of({"log.csv": b"".join(log[:200]), "arm.urdf": (SAMPLES / "arm.urdf").read_bytes(),
                        "arm.toml": (SAMPLES / "arm.toml").read_bytes()})  # fmt: skip
    for ending in ENDINGS[1:]:
        made(folder, "convert", "log.csv", "-o", f"log.{ending}")
    made(folder, "differentiate", "-q", "log.parquet", "-o", "motion.parquet")
    made(folder, "identify", "-q", "motion.parquet", "--save", "state.npz", "-o", "par.parquet")
    made(folder, "tune", "-q", "log.parquet", "--save", "settings.toml", "-o", "trials.csv")
    made(folder, "trajgen", "-q", "--duration", "3", "-o", "reference.parquet")
    (folder / ROBOT).write_bytes(
        (SAMPLES.parent / "scarid_cli/algorithms/robots/scara2.toml").read_bytes()
    )
    content = {
        path.name: path.read_bytes() for path in folder.iterdir() if not path.name.startswith(".")
    }
    removed(folder)
    return content
