"""How the rows of a motion are treated."""

from __future__ import annotations

from dataclasses import dataclass

from scarid_cli.algorithms.regression.counting import Counting

# One for all joints, or the errors of each in several directions (directions, joints), in each of
# which they are wrong together.
GainErrors = float | tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class Treatment:
    """How the rows of a motion are treated before the fit.

    `skip` rows at the start and at the end of the table are left out. W and the torques are
    decimated by each factor of `decimate` in turn. Rows of a joint that is slower than `slow`
    (joints) [rad/s or m/s] are left out, and those near a reversal or standstill as `counting`
    says; it is None if all rows count. Five more options concern the fit: `align` also fits the
    time by which the torques lead the motion, `essential` drops parameters that are not essential,
    `choose_friction` adds what friction is worth fitting, `consistent` asks for estimates that
    rigid bodies can have, and `gain_errors` are the relative standard errors of the torque
    constants.
    """

    skip: tuple[int, int] = (0, 0)
    decimate: tuple[int, ...] = ()
    slow: tuple[float, ...] = ()
    counting: Counting | None = None
    align: bool = False
    essential: bool = False
    consistent: bool = False
    choose_friction: bool = False
    gain_errors: GainErrors = 0.0

    @property
    def holds(self) -> bool:
        """Whether the treatment needs all rows at once."""
        return bool(self.decimate) or self.align
