"""From the options of `scarid trajgen --optimise` to the best motion that is found."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.trajectories.curve import Curve
from scarid_cli.algorithms.trajectories.limits import Limits
from scarid_cli.arrays import Array
from scarid_cli.cli.running.job import Job, per_joint
from scarid_cli.cli.running.progress import steps
from scarid_cli.errors import UsageFault
from scarid_cli.stages import design as stage

if TYPE_CHECKING:
    from scarid_cli.algorithms.design.aims import Aim

BALANCED, DEFAULT_BUDGET = "balanced", 10.0
ONLY_OPTIMISED = ("criterion", "wanted", "budget", "starts", "workspace")
OPTIONS = {"wanted": "for"}


@dataclass(frozen=True)
class Asked:
    """What an optimised motion is to tell: the noise of the torques, and what is known already."""

    noise: Array | None
    known: Array


def asked(job: Job, robot: Robot, given: dict[str, Any]) -> Asked:
    """The noise that is given, else that of earlier experiments, else that of the description."""
    for name in ONLY_OPTIMISED:
        if given[name] is not None and not given["optimise"]:
            raise UsageFault(f"--{OPTIONS.get(name, name)} needs --optimise")
    before = None
    if given["after"]:
        before = stage.earlier(job.read(given["after"], "parameters"), robot)
    count, joints = len(robot.parameters), len(robot.joints)
    own = np.array([joint.torque_noise for joint in robot.joints])
    if given["torque_noise"]:
        own = np.array(per_joint(given["torque_noise"], joints, "--torque-noise"))
        if not (own > 0.0).all():
            raise UsageFault("--torque-noise must be positive")
    elif before:
        own = before.noise
    known = before.information if before else np.zeros((count, count))
    noise = own if (own > 0.0).all() else None
    if given["expected"] and noise is None:
        raise UsageFault(
            f"--expected needs the torque noise, which {robot.name} does not state; give "
            "--torque-noise"
        )
    return Asked(noise, known)


@dataclass(frozen=True)
class Found:
    """An optimised motion, and what is reported of it."""

    curve: Curve
    starts: int
    limited: str


def optimised(
    job: Job,
    robot: Robot,
    limits: Limits,
    home: Array,
    excitation: Any,
    wish: Asked,
    given: dict[str, Any],
) -> Found:
    """The best motion of several starts."""
    if not hasattr(excitation, "basis"):
        raise UsageFault("--optimise: the excitation must be spline or fourier")
    from scarid_cli.algorithms.design.criteria import goal
    from scarid_cli.algorithms.design.problem import Wanted, margins
    from scarid_cli.algorithms.design.search import search

    aim, some = _wanted(robot, given)
    criterion = given["criterion"] or ("d" if some else BALANCED)
    limits.require_room(home)
    goal(criterion, np.eye(aim.columns), some)  # refused before other processes start
    laws = stage.laws(robot, home, _box(given["workspace"]))
    wanted = Wanted(
        aim.model,
        excitation.basis(limits, given["duration"]),
        home,
        limits,
        laws,
        criterion,
        np.ones(len(home)) if wish.noise is None else wish.noise,
        given["rate"] * given["repeat"],
        np.zeros((aim.columns, aim.columns)) if aim.wanted else wish.known,
        some,
    )
    budget = given["budget"] or DEFAULT_BUDGET
    count = given["starts"]
    within = None if count else budget
    with steps(quiet=job.quiet, of="starts", total=count, within=within) as progress:
        best = search(wanted, given["seed"], count, budget, progress)
    limited = stage.limiting(best.curve, limits, margins(best.curve, laws), laws)
    return Found(best.curve, best.starts, limited)


def _wanted(robot: Robot, given: dict[str, Any]) -> tuple[Aim, tuple[int, ...]]:
    """What --for names: the columns of a motion's information, and which of them are wanted."""
    from scarid_cli.algorithms.design.aims import AIMS, Aim
    from scarid_cli.algorithms.design.model import Model

    wish = given["wanted"]
    if wish in AIMS:
        if given["after"]:
            raise UsageFault(f"--for {wish}: --after complements parameters; leave it out")
        aim = AIMS[wish](robot)
        return aim, tuple(range(aim.wanted))
    names: Sequence[str] = [name.strip() for name in wish.split(",")] if wish else []
    for name in names:
        if name not in robot.names:
            raise UsageFault(
                f"--for: no parameter {name!r}; there are {', '.join(robot.names)}, and alone "
                f"{' or '.join(AIMS)}"
            )
    parameters = Aim(Model.of(robot), len(robot.parameters), 0)
    return parameters, tuple(robot.names.index(name) for name in names)


def _box(numbers: tuple[float, ...] | None) -> tuple[float, ...] | None:
    if numbers is None:
        return None
    if len(numbers) != 6 or not all(
        low < high for low, high in zip(numbers[::2], numbers[1::2], strict=True)
    ):
        raise UsageFault("--workspace: give XMIN,XMAX,YMIN,YMAX,ZMIN,ZMAX, each pair increasing")
    return numbers
