"""The rigid-body part of a regressor from a URDF, through Pinocchio (the extra `urdf`).

Columns are those of the ten standard parameters of each link, in the order of SYMBOLS: moments of
inertia about the link's frame [kg m2], first moments [kg m], mass [kg].
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault

SYMBOLS = ("Ixx", "Ixy", "Ixz", "Iyy", "Iyz", "Izz", "mx", "my", "mz", "m")
UNITS = ("kg m2",) * 6 + ("kg m",) * 3 + ("kg",)
PINOCCHIO = np.array([4, 5, 7, 6, 8, 9, 1, 2, 3, 0])  # where it keeps them


@cache
def _model(path: str) -> Any:
    try:
        import pinocchio
    except ImportError:
        raise UsageFault(f"{path}: a URDF needs Pinocchio: pip install 'scarid[urdf]'") from None
    if not Path(path).is_file():
        raise UsageFault(f"{path}: no such file")
    try:
        model = pinocchio.buildModelFromUrdf(path)
    except (RuntimeError, ValueError) as error:
        raise UsageFault(f"{path}: not a URDF: {' '.join(str(error).split())}") from None
    if not model.nq or model.nq != model.nv:
        raise UsageFault(f"{path}: only revolute and prismatic joints with limits are understood")
    return model


@dataclass(frozen=True)
class Body:
    """A serial arm as a URDF describes it."""

    path: str

    @property
    def types(self) -> tuple[str, ...]:
        """Of the joints that move: revolute or prismatic."""
        names = (joint.shortname() for joint in list(_model(self.path).joints)[1:])
        return tuple("prismatic" if "JointModelP" in name else "revolute" for name in names)

    def columns(self, q: Array, dq: Array, ddq: Array) -> Array:
        """The regressor of the standard parameters (samples, joints, 10 joints)."""
        import pinocchio

        model = _model(self.path)
        data = model.createData()
        joints, samples = q.shape
        W = np.empty((samples, joints, 10 * joints))
        order = (10 * np.arange(joints)[:, None] + PINOCCHIO).ravel()
        for k in range(samples):
            Y = pinocchio.computeJointTorqueRegressor(model, data, q[:, k], dq[:, k], ddq[:, k])
            W[k] = Y[:, order]
        return W
