"""How `aise` depends on its settings, beside `deadbeat`: the figures of docs/theory.md.

The motions are those of differentiators.py, measured by encoders of 13 and 16 bit. The error is 100
times the geometric mean of the root of NRMSE v times NRMSE a. A record diverges if the error of the
acceleration exceeds ten times its standard deviation.
"""

from __future__ import annotations

import numpy as np
from scores import geometric
from signals import H, errors, motions, seen

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.algorithms.processes.matching import over

ORDERS = (1, 2, 4, 8, 12, 25)
BANDWIDTHS = (20.0, 40.0, 90.0, 180.0, 300.0)  # [rad/s]


def found(name: str, bits: int, **settings: float) -> list[tuple[float, float]]:
    """NRMSE of velocity and acceleration on each motion."""
    method = DIFFERENTIATORS.load(name)(**settings)
    with np.errstate(all="ignore"):
        return [
            errors(*over(method, seen(motion.q, bits, seed), H), motion)
            for seed, motion in enumerate(motions())
        ]


def main() -> None:
    print("Order of aise: records that diverge, of 12")
    for order in ORDERS:
        wrong = [a for bits in (13, 16) for _, a in found("aise", bits, order=order)]
        print(f"  {order:2}  {sum(not a < 10.0 for a in wrong)}")
    print("Error by bandwidth [rad/s] at 13 and 16 bit: aise, deadbeat")
    for bandwidth in BANDWIDTHS:
        row = [
            100.0 * geometric([np.sqrt(v * a) for v, a in found(name, bits, bandwidth=bandwidth)])
            for name in ("aise", "deadbeat")
            for bits in (13, 16)
        ]
        print(f"  {bandwidth:3.0f}" + "".join(f"{x:8.2f}" for x in row))


if __name__ == "__main__":
    main()
