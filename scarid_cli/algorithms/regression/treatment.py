"""How the rows of a motion are treated."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Treatment:
    """How the rows of a motion are treated before the fit.

    `skip` rows at the start and at the end of the table are left out. W and the torques are
    decimated by each factor of `decimate` in turn. Rows of a joint that is slower than `slow`
    (joints) [rad/s or m/s] are left out. Two more options concern the fit: `align` also fits the
    time by which the torques lead the motion, and `essential` drops parameters that are not
    essential.
    """

    skip: tuple[int, int] = (0, 0)
    decimate: tuple[int, ...] = ()
    slow: tuple[float, ...] = ()
    align: bool = False
    essential: bool = False

    @property
    def holds(self) -> bool:
        """Whether the treatment needs all rows at once."""
        return bool(self.decimate) or self.align
