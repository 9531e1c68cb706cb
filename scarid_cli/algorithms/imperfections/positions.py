"""Imperfections of the measured positions."""

from __future__ import annotations

from scarid_cli.algorithms.imperfections.declared import POSITION, Number, PerJoint


class EncoderBits(PerJoint):
    """Resolution of the encoder, per turn (0: perfect).

    The controller and the log read the nearest multiple of 2 pi / 2^bits [rad]. It replaces the
    `encoder_resolution` of the description, and does not apply to prismatic joints.
    """

    NAME = "encoder-bits"
    NUMBERS = (Number("bits", low=0.0, high=40.0, whole=True),)


class EncoderEccentricity(PerJoint):
    """Amplitude of an error that the encoder makes once per turn.

    The controller and the log read q + A sin(n q + phase), with the amplitude A, n of
    `encoder-turns` and the phase of `encoder-phase`.
    """

    NAME = "encoder-eccentricity"
    NUMBERS = (Number(POSITION, low=0.0),)


class EncoderPhase(PerJoint):
    """Phase of the eccentricity of the encoder at q = 0."""

    NAME = "encoder-phase"
    NUMBERS = (Number("rad"),)
    NEEDS = "encoder-eccentricity"


class EncoderTurns(PerJoint):
    """Turns of the encoder per turn of the joint (default: 1).

    The eccentricity is A sin(n q + phase), with n = 1 for an encoder on the joint, and the gear
    ratio for one on the motor. For a prismatic joint n is 2 pi over the travel per turn [rad/m].
    """

    NAME = "encoder-turns"
    NUMBERS = (Number(default=1.0),)
    NEEDS = "encoder-eccentricity"


class PositionNoise(PerJoint):
    """Standard deviation of white noise on the position.

    It is added before the encoder quantises, independently in each control period; the controller
    sees it as well.
    """

    NAME = "position-noise"
    NUMBERS = (Number(POSITION, low=0.0),)


class ColouredPositionNoise(PerJoint):
    """Standard deviation of coloured noise on the position.

    A first-order Gauss-Markov process: n(k+1) = a n(k) + s sqrt(1 - a^2) w(k), with a = exp(-h /
    T), the control period h, the standard deviation s, the correlation time T of
    `position-noise-time` and white noise w of unit variance. It is added before the encoder
    quantises; the controller sees it as well.
    """

    NAME = "coloured-position-noise"
    NUMBERS = (Number(POSITION, low=0.0),)
    NEEDS = "position-noise-time"


class PositionNoiseTime(PerJoint):
    """Correlation time of the coloured noise on the position."""

    NAME = "position-noise-time"
    NUMBERS = (Number("s", low=0.0),)
    NEEDS = "coloured-position-noise"


class PositionDelay(PerJoint):
    """Delay of the logged position.

    The row at t has the position of t - delay. A whole number of control periods shifts the
    readings of the controller. In between, the encoder reads the true position at that instant,
    interpolated by the polynomial of fourth order through position and velocity at both ends of the
    control period and the acceleration at its start; its noise is that of the start of the period.
    Before the start, the first reading is held.
    """

    NAME = "position-delay"
    NUMBERS = (Number("s", low=0.0),)


class PositionRate(PerJoint):
    """Update rate of the logged position (0: that of the log).

    The row at t has the position of T floor(t / T), held in between, with the period T of the
    sensor. A delay applies after that.
    """

    NAME = "position-rate"
    NUMBERS = (Number("Hz", low=0.0),)


class PositionOutliers(PerJoint):
    """Probability of an outlier in a logged position.

    With this probability, plus or minus `position-outlier-size` is added to a value of the log. The
    controller does not see it.
    """

    NAME = "position-outliers"
    NUMBERS = (Number(low=0.0, high=1.0),)
    NEEDS = "position-outlier-size"


class PositionOutlierSize(PerJoint):
    """Size of the outliers of the position."""

    NAME = "position-outlier-size"
    NUMBERS = (Number(POSITION, low=0.0),)
    NEEDS = "position-outliers"
