"""Entries for the rows that count and for the low-passes: they widen intervals always."""

from __future__ import annotations

from scarid_cli.algorithms.beyond.phenomenon import Phenomenon


class Reversals(Phenomenon):
    """Friction beside a reversal: the estimates without the rows that are near one."""

    NAME = "reversals"
    LACKS = (
        "friction near reversals differs from the model (--drop-slow leaves more of the slow rows "
        "out)"
    )
    ALWAYS = True


class Parallel(Phenomenon):
    """Another soft sensor: differences of the positions, behind one window with the torques."""

    NAME = "parallel"
    ALWAYS = True


class LowPass(Phenomenon):
    """Torques that lead as behind a low-pass rather than as behind a delay, or the reverse."""

    NAME = "low-pass"
    IMPERFECTIONS = ("torque-bandwidth",)
    CHANGE = "low-pass"
    ALWAYS = True
