"""Running a batch without Snakemake, and what it leaves."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from conftest import ROOT

WORKFLOW = ROOT / "workflow"


def in_one_process(config: Path) -> subprocess.CompletedProcess[str]:
    """All steps of a batch, one after the other."""
    return subprocess.run(
        [sys.executable, "-m", "steps", "all", config.name],
        cwd=config.parent,
        env={**os.environ, "PYTHONPATH": str(WORKFLOW)},
        capture_output=True,
        text=True,
        check=False,
    )


def outcome(folder: Path) -> dict[str, bytes]:
    """All that a batch in this folder leaves for the user, by its path."""
    out = folder / "outcome"
    paths = (path for path in out.rglob("*") if path.is_file() and "jobs" not in path.parts)
    return {str(path.relative_to(out)): path.read_bytes() for path in paths if path.name != ".lock"}
