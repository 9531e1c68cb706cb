"""The columns by which logs are compared: the parameters, and what these cannot express."""

from __future__ import annotations

from dataclasses import dataclass

TILTS = 2  # directions in which a base may be tilted


@dataclass(frozen=True)
class Columns:
    """Their places for so many parameters and joints, in this order.

    The parameters; the delay of all torques [s]; of each joint the relative error of its motor
    constant and the offset of its torque [N m or N]. The following ones are in question only where
    one of them explains a difference better than all else: the zero of each joint [rad or m], the
    tilt of the base about two axes [rad], and the second derivative of the torques [s2].
    """

    parameters: int
    joints: int

    @classmethod
    def among(cls, count: int, joints: int) -> Columns:
        """Those of which there are so many."""
        return cls(count - cls(0, joints).count, joints)

    @property
    def delay(self) -> int:
        return self.parameters

    @property
    def motors(self) -> range:
        return range(self.delay + 1, self.delay + 1 + self.joints)

    @property
    def offsets(self) -> range:
        return range(self.motors.stop, self.motors.stop + self.joints)

    @property
    def zeros(self) -> range:
        return range(self.offsets.stop, self.offsets.stop + self.joints)

    @property
    def tilts(self) -> range:
        return range(self.zeros.stop, self.zeros.stop + TILTS)

    @property
    def bend(self) -> int:
        return self.tilts.stop

    @property
    def count(self) -> int:
        return self.bend + 1

    @property
    def usual(self) -> int:
        """The number of the first columns, which are always in question."""
        return self.zeros.start
