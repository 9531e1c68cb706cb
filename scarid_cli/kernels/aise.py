"""Adaptive input and state estimation (Verma, Sanjeevini, Sumer and Bernstein 2024).

The motion is a double integrator whose input, the acceleration, is unknown; see docs/theory.md.
"""


def assimilated(z, state, gains, bounds, h):
    """Correct the forecast state, whose error is z, and write the gain to gains[0].

    The variances of the input's error and of the measurement are those that explain the variance
    of the errors of all forecasts so far; see `differentiate` for `state` and `bounds`.
    """
    state[5] += 1.0
    off = z - state[6]
    state[6] += off / state[5]
    state[7] += off * (z - state[6])
    p11 = state[2] + 2.0 * h * state[3] + h * h * state[4]
    p12 = state[3] + h * state[4]
    p22 = state[4]
    eta, noise = bounds[0], 0.0
    left = state[7] / state[5] - p11
    if left > eta:
        least = left - bounds[1] if left > bounds[1] else 0.0
        noise = bounds[2] * least + (1.0 - bounds[2]) * (left - eta)
        eta = left - noise
    p11 += eta
    p22 += eta
    gains[0, 0] = p11 / (p11 + noise)
    gains[0, 1] = p12 / (p11 + noise)
    state[0] -= gains[0, 0] * z
    state[1] -= gains[0, 1] * z
    state[2] = p11 - gains[0, 0] * p11
    state[3] = p12 - gains[0, 0] * p12
    state[4] = p22 - gains[0, 1] * p12


def regressors(past, gains, rows, h):
    """Write the regressor of the input to rows[0], and what it did to the error to rows[1].

    Returned is what the past inputs themselves did to the error.
    """
    order = len(rows[0]) // 2
    for j in range(2 * order + 1):
        rows[0, j] = past[0, j] if j < order else past[1, j - order]
        rows[1, j] = 0.0
    c1, c2, total = 1.0, 0.0, 0.0
    for i in range(len(gains) - 1):
        if i > 0:  # times A (I - K C), with the gain K of i samples ago
            c2 += h * c1
            c1 -= c1 * gains[i, 0] + c2 * gains[i, 1]
        effect = h * (0.5 * h * c1 + c2)
        total += effect * past[0, i]
        for j in range(order):
            rows[1, j] += effect * past[0, i + 1 + j]
        for j in range(order + 1):
            rows[1, order + j] += effect * past[1, i + 1 + j]
    return total


def weighed(row, error, variance, theta, P, work):
    """Update the coefficients theta and their P by a row of least squares with this residual."""
    size = len(theta)
    total = variance
    for i in range(size):
        work[i] = 0.0
        for j in range(size):
            work[i] += P[i, j] * row[j]
        total += row[i] * work[i]
    for i in range(size):
        theta[i] -= work[i] / total * error
        for j in range(size):
            P[i, j] -= work[i] * work[j] / total


def product(row, theta):
    """The sum of row times theta."""
    total = 0.0
    for i in range(len(theta)):
        total += row[i] * theta[i]
    return total


def pushed(row, newest):
    """Shift the row by one place and put the newest number in front."""
    for i in range(len(row) - 1, 0, -1):
        row[i] = row[i - 1]
    row[0] = newest


def differentiate(g, v, a, state, theta, P, past, gains, rows, weights, h):
    """Write the velocities v and accelerations a of the positions g.

    All but g, weights and h are changed in place. state (8): forecast position and velocity; the
    covariance (11, 12, 22) of the last state; number, mean and squared deviations of the errors of
    the forecasts. theta (2 order + 1): coefficients of past inputs and of errors. P: the inverse
    of their information. past (2, order + window + 1): inputs from the last sample back, errors
    from the present one back. gains (window + 1, 2): those of the state, newest first.
    rows (3, 2 order + 1): work space. weights (4): least and largest variance of the input's error,
    share of the least measurement noise, and weight of the squared input. h: sampling period [s].
    """
    size, lags = len(theta), len(past[0])
    if len(v) != len(g) or len(a) != len(g) or len(state) != 8 or len(weights) != 4:
        raise ValueError("aise: lengths differ")
    if len(P) != size or P.shape[1] != size or len(rows) != 3 or rows.shape[1] != size:
        raise ValueError("aise: lengths differ")
    if len(past) != 2 or gains.shape[1] != 2 or lags != size // 2 + len(gains) or size % 2 != 1:
        raise ValueError("aise: lengths differ")
    for k in range(len(g)):
        z = float(state[0]) - float(g[k])
        pushed(past[1], z)
        for i in range(len(gains) - 1, 0, -1):
            gains[i, 0], gains[i, 1] = gains[i - 1, 0], gains[i - 1, 1]
        assimilated(z, state, gains, weights, h)
        caused = regressors(past, gains, rows, h)
        u = product(rows[0], theta)
        weighed(rows[1], z - caused + product(rows[1], theta), 1.0, theta, P, rows[2])
        weighed(rows[0], product(rows[0], theta), 1.0 / weights[3], theta, P, rows[2])
        v[k] = state[1]
        a[k] = u
        state[0] += h * (state[1] + 0.5 * h * u)
        state[1] += h * u
        pushed(past[0], u)
