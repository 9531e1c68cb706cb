"""Imperfections of the logged torques; the torques that move the robot are not affected."""

from __future__ import annotations

from scarid_cli.algorithms.imperfections.declared import TORQUE, Number, PerJoint


class TorqueConstantError(PerJoint):
    """Relative error of the motor constant in the log.

    logged = (1 + e) commanded: 0.05 makes the logged torque 5 % too large.
    """

    NAME = "torque-constant-error"
    NUMBERS = (Number(low=-1.0),)


class TorqueOffset(PerJoint):
    """Constant offset of the logged torque.

    logged = commanded + offset.
    """

    NAME = "torque-offset"
    NUMBERS = (Number(TORQUE),)


class TorqueBandwidth(PerJoint):
    """Bandwidth of the low-pass on the logged torque (0: none).

    A first-order low-pass: dy/dt = 2 pi f (u - y), with the torque u, constant within a control
    period, the logged torque y and the bandwidth f. It is solved exactly, and starts at the first
    torque.
    """

    NAME = "torque-bandwidth"
    NUMBERS = (Number("Hz", low=0.0),)


class TorqueDelay(PerJoint):
    """Delay of the logged torque.

    The row at t has the torque of t - delay. It is constant within a control period, and
    exponential behind a low-pass; it is evaluated exactly at that instant, with the noise of the
    start of the period. Before the start, the first torque is held.
    """

    NAME = "torque-delay"
    NUMBERS = (Number("s", low=0.0),)


class TorqueRate(PerJoint):
    """Update rate of the logged torque (0: that of the log).

    The row at t has the torque of T floor(t / T), held in between, with the period T of the sensor.
    A delay applies after that.
    """

    NAME = "torque-rate"
    NUMBERS = (Number("Hz", low=0.0),)


class TorqueNoise(PerJoint):
    """Standard deviation of white noise on the logged torque.

    It is independent from one control period to the next, and replaces the `torque_noise` of the
    joints of the description.
    """

    NAME = "torque-noise"
    NUMBERS = (Number(TORQUE, low=0.0),)


class ColouredTorqueNoise(PerJoint):
    """Standard deviation of coloured noise on the logged torque.

    A first-order Gauss-Markov process, as for `coloured-position-noise`, with the correlation time
    of `torque-noise-time`.
    """

    NAME = "coloured-torque-noise"
    NUMBERS = (Number(TORQUE, low=0.0),)
    NEEDS = "torque-noise-time"


class TorqueNoiseTime(PerJoint):
    """Correlation time of coloured noise on the logged torque."""

    NAME = "torque-noise-time"
    NUMBERS = (Number("s", low=0.0),)
    NEEDS = "coloured-torque-noise"


class TorqueResolution(PerJoint):
    """Resolution of the logged torque (0: perfect).

    The log has the nearest multiple of the resolution, after all noise.
    """

    NAME = "torque-resolution"
    NUMBERS = (Number(TORQUE, low=0.0),)


class TorqueOutliers(PerJoint):
    """Probability of an outlier in a logged torque.

    With this probability, plus or minus `torque-outlier-size` is added to a value of the log.
    """

    NAME = "torque-outliers"
    NUMBERS = (Number(low=0.0, high=1.0),)
    NEEDS = "torque-outlier-size"


class TorqueOutlierSize(PerJoint):
    """Size of the outliers of the torque."""

    NAME = "torque-outlier-size"
    NUMBERS = (Number(TORQUE, low=0.0),)
    NEEDS = "torque-outliers"
