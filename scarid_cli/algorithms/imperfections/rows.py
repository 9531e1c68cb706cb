"""Imperfections of the rows of the log and of their clock, and standstill around the motion."""

from __future__ import annotations

from scarid_cli.algorithms.imperfections.declared import Number, OfTheRobot


class SamplingJitter(OfTheRobot):
    """Deviation of sampling instants that the stamps show.

    The row of the nominal time t_k is sampled and stamped at t_k + d, with normal d of this
    standard deviation. This is a logger that polls at irregular intervals and reads a good clock.
    Each of the three jitters is limited to 0.24 log periods to either side, so that time never runs
    backwards.
    """

    NAME = "sampling-jitter"
    NUMBERS = (Number("s", low=0.0),)


class StampJitter(OfTheRobot):
    """Deviation of the stamps of samples taken on time.

    The row of the nominal time t_k is sampled at t_k and stamped t_k + d, with normal d of this
    standard deviation. This is a real-time controller whose rows are stamped when they arrive at
    another computer.
    """

    NAME = "stamp-jitter"
    NUMBERS = (Number("s", low=0.0),)


class HiddenJitter(OfTheRobot):
    """Deviation of sampling instants that no stamp shows.

    The row of the nominal time t_k is sampled at t_k + d, with normal d, and stamped t_k. This is a
    logger that polls at irregular intervals and counts the rows.
    """

    NAME = "hidden-jitter"
    NUMBERS = (Number("s", low=0.0),)


class LostRows(OfTheRobot):
    """Probability that a row of the log is lost."""

    NAME = "lost-rows"
    NUMBERS = (Number(low=0.0, high=0.9),)


class RepeatedRows(OfTheRobot):
    """Probability that a row repeats that before.

    The measured values and the reference are repeated with a new time stamp (held samples). The
    true values of the row are those of its own instant.
    """

    NAME = "repeated-rows"
    NUMBERS = (Number(low=0.0, high=1.0),)


class StandstillBefore(OfTheRobot):
    """Time at rest at the first reference, before the motion.

    The log starts at the time at which the reference starts, and the motion is later by this time,
    which is rounded to whole control periods.
    """

    NAME = "standstill-before"
    NUMBERS = (Number("s", low=0.0),)


class StandstillAfter(OfTheRobot):
    """Time at rest at the last reference, after the motion."""

    NAME = "standstill-after"
    NUMBERS = (Number("s", low=0.0),)
