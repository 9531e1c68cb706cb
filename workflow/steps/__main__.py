"""One job of a batch: `python -m steps STEP CONFIG [ROBOT [GROUP]]`, with `all` for a whole batch.

The jobs of one batch are ordered by `workflow/Snakefile`.
"""

from __future__ import annotations

import contextlib
import fcntl
import sys
from collections.abc import Callable, Iterator

from steps import plan as plans
from steps.collect import collect
from steps.identify import identify
from steps.plan import Plan, PlanError
from steps.reference import reference
from steps.tune import tune
from steps.validate import validate

from scarid_cli.__main__ import WithoutPandas

OF_GROUPS = {"identify": identify, "validate": validate}
OF_ROBOTS = {"tune": tune, "reference": reference}
STEPS: dict[str, Callable[..., None]] = {**OF_GROUPS, **OF_ROBOTS}


def everything(plan: Plan) -> None:
    """The whole batch in this process, without Snakemake: what the benchmarks compare with."""
    for robot in plan.robots:
        for step in ("tune", "identify", "reference", "validate"):
            groups = [[group] for group in plan.groups(robot)] if step in OF_GROUPS else [[]]
            for words in groups:
                STEPS[step](plan, robot, *words)
    collect(plan)


WHOLE = {"collect": collect, "all": everything}


@contextlib.contextmanager
def locked(plan: Plan, *words: str) -> Iterator[None]:
    """Wait for the same job of an earlier run, which may go on after its Snakemake was killed."""
    place = plan.out / "jobs" / "locks" / ".".join(words)
    place.parent.mkdir(parents=True, exist_ok=True)
    with place.open("w") as file:
        with contextlib.suppress(OSError):  # a file system without locks
            fcntl.flock(file, fcntl.LOCK_EX)
        yield


def main(step: str, config: str, *words: str) -> None:
    """Run one step."""
    plan = plans.read(config)
    with locked(plan, step, *words):
        if step in STEPS:
            STEPS[step](plan, plan.robot(words[0]), *words[1:])
        else:
            WHOLE[step](plan)


if __name__ == "__main__":
    sys.meta_path.insert(0, WithoutPandas())  # which Snakemake brings along
    try:
        main(*sys.argv[1:])
    except PlanError as error:
        sys.exit(f"batch: {error}")
