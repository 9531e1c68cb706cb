"""Start a batch: `python workflow/batch.py CONFIG [--profile NAME] [options of Snakemake]`.

`make batch` makes the environment first. Paths in the configuration are relative to its folder, in
which everything runs. One batch at a time works there: the lock is the kernel's, so that one that
was killed leaves none behind.
"""

from __future__ import annotations

import argparse
import fcntl
import os
import sys
from pathlib import Path

from steps import plan

HERE = Path(__file__).resolve().parent


def main() -> None:
    """Check the configuration, take the lock, and become Snakemake."""
    parser = argparse.ArgumentParser(prog="batch", description=__doc__.partition("\n")[0])
    parser.add_argument("config", type=Path)
    parser.add_argument("--profile", default="local", help="local, slurm, kubernetes, or a folder")
    given, more = parser.parse_known_args()
    if not given.config.is_file():
        sys.exit(f"batch: {given.config}: no such file")
    profile = HERE / "profiles" / given.profile
    profile = profile if profile.is_dir() else Path(given.profile).resolve()
    if not profile.is_dir():
        sys.exit(f"batch: --profile {given.profile}: no such profile or folder")
    os.chdir(given.config.resolve().parent)
    try:
        found = plan.read(given.config.name)
    except plan.PlanError as error:
        sys.exit(f"batch: {error}")
    out = found.out
    _say(found)
    out.mkdir(parents=True, exist_ok=True)
    lock = os.open(out / ".lock", os.O_RDWR | os.O_CREAT, 0o666)
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        sys.exit(f"batch: another batch is at work in {out}; wait for its end")
    os.set_inheritable(lock, True)  # noqa: FBT003
    words = [sys.executable, "-m", "snakemake", "--config", f"batch={given.config.name}"]
    words += ["--snakefile", str(HERE / "Snakefile"), "--profile", str(profile), "--nolock"]
    os.execv(words[0], [*words, *more])


def _say(found: plan.Plan) -> None:
    """The first line of a batch: what is going to be done."""
    logs = sum(len(robot.logs) for robot in found.robots)
    groups = sum(len(found.groups(robot)) for robot in found.robots)
    what = f"{_counted(logs, 'log')} of {_counted(len(found.robots), 'robot')}"
    page = found.out.resolve() / "fleet.html"
    where = f"its page is {page}" + (", which is there from before" if page.exists() else "")
    print(
        f"batch: {what} in {_counted(groups, 'group')}: check, identify, validate; {where}",
        file=sys.stderr,
        flush=True,
    )


def _counted(count: int, what: str) -> str:
    return f"{count:,} {what}{'' if count == 1 else 's'}"


if __name__ == "__main__":
    main()
