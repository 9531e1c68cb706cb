"""How often the verdict names what the model of a robot lacks: `python benchmarks/named.py`.

Logs of the gauntlet in which the model lacks one thing, and clean ones, identified by the blind
procedure. *Right* are the verdicts that name this, *other* those that name something else, *none*
those that name nothing because no parameter moves by more than its error [%].
"""

from __future__ import annotations

import argparse
import re
from collections import Counter
from concurrent.futures import ProcessPoolExecutor

import numpy as np
from altered import Recorded, coulomb
from conditions import CONDITIONS, UNSEEN, Condition, log, robot_named
from gauntlet import blind
from mechanics import velocity

from scarid_cli.algorithms.beyond.catalogue import PHENOMENA
from scarid_cli.algorithms.beyond.gears import (
    Backlash,
    ElasticGear,
    ElasticJoint,
    Hysteresis,
    LatePosition,
    LateTorque,
    Presliding,
)
from scarid_cli.algorithms.beyond.mounting import Geometry
from scarid_cli.algorithms.beyond.phenomenon import Phenomenon
from scarid_cli.algorithms.beyond.positions import Elasticity, Encoders, Late, Zeros
from scarid_cli.algorithms.beyond.rows import Reversals
from scarid_cli.algorithms.beyond.torques import (
    Asymmetry,
    Cable,
    Curvature,
    Drift,
    LoadFriction,
    Offset,
    Ripple,
    Saturation,
    SlowFriction,
    Spring,
    Stribeck,
    Uneven,
    Warming,
)
from scarid_cli.algorithms.robots.description import Robot


def zeroed(_: Robot, log: Recorded) -> Recorded:
    """The logged positions are .05 rad too large and too small, by turns."""
    t, q, tau = log
    return t, q + 0.05 * np.where(np.arange(len(q)) % 2, -1.0, 1.0)[:, None], tau


def sided(robot: Robot, log: Recorded) -> Recorded:
    """Viscous friction grows by a quarter of Coulomb friction, in both directions."""
    t, q, tau = log
    speed = np.abs(velocity(log))
    return t, q, tau + 0.25 * coulomb(robot) * speed / speed.max(axis=1, keepdims=True)


OWN = [
    Condition(
        "flexible joint 15 Hz, link encoder", {"flexibility": (15.0,), "encoder-side": ("link",)}
    ),
    Condition("zeros off", altered=zeroed),
    Condition("asymmetric viscous friction", altered=sided),
]
# Which entries are a right name for what the log has: some say the same of it.
LACKING: dict[str, tuple[type[Phenomenon], ...]] = {
    "clean": (),
    "torque offset": (Offset,),
    "asymmetric friction": (Offset,),  # of Coulomb's
    "asymmetric viscous friction": (Asymmetry,),
    "Stribeck friction": (SlowFriction, Stribeck, Curvature),
    "load friction": (LoadFriction,),
    "cable pulls": (Spring,),
    "cubic cable": (Cable,),
    "motor saturates": (Saturation,),
    "torque drifts": (Drift,),
    "friction drifts": (Warming,),
    "torque ripple": (Ripple,),
    "Coulomb friction over the position 30 %": (Uneven,),
    "link length +1 %": (Geometry,),
    "position of joint 2 late 10 ms": (LatePosition, Late),
    "torque of joint 2 late 10 ms": (LateTorque, Late),
    "flexible joint 15 Hz, motor encoder": (ElasticGear, Elasticity),
    "flexible joint 15 Hz, link encoder": (ElasticJoint,),
    "backlash 0.2 deg": (Backlash,),
    "torque hysteresis 2 %": (Hysteresis,),
    "Maxwell slip 60 mrad": (Presliding, Reversals),
    "eccentric encoder": (Encoders,),
    "zeros off": (Zeros,),
}
FITTED = "offsets of the torques"  # which are not alternatives, but fitted with the parameters
KNOWN = {condition.name: condition for condition in (*CONDITIONS, *UNSEEN, *OWN)}
SEED = 30_000


def named(job: tuple[str, str, int]) -> list[type[Phenomenon]]:
    """The entries of the catalogue that the verdict on a log names."""
    name, condition, seed = job
    result, _ = blind(name, log(robot_named(name), KNOWN[condition], seed))
    reasons = "; ".join(result.meta.extra["reasons"])
    entries = [kind for kind in PHENOMENA.values() if kind.LACKS]
    words = {kind: max(re.split(r"{\w+}", kind.LACKS), key=len) for kind in entries}
    fitted: list[type[Phenomenon]] = [Offset] if FITTED in reasons else []
    return [*fitted, *(kind for kind, text in words.items() if text in reasons)]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robots", default="scara2,planar2-gravity,ur10")
    parser.add_argument("--logs", type=int, default=40, help="of each condition")
    given = parser.parse_args()
    print(f"{'':56}{'right':>7}{'other':>7}{'none':>7}")
    with ProcessPoolExecutor(2) as pool:
        for name in given.robots.split(","):
            for condition, lacking in LACKING.items():
                jobs = [(name, condition, SEED + k) for k in range(given.logs)]
                found: Counter[str] = Counter()
                for one in pool.map(named, jobs):
                    found["right" if {*one} & {*lacking} else "other" if one else "none"] += 1
                shares = [100 * found[what] // given.logs for what in ("right", "other", "none")]
                print(
                    f"{name + ', ' + condition:56}" + "".join(f"{x:7d}" for x in shares), flush=True
                )


if __name__ == "__main__":
    main()
