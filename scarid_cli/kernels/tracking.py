"""Tracking differentiator (Han 2009) with the discrete time-optimal law fhan."""

from math import sqrt


def fhan(e, v, r, h0):
    """The acceleration, at most r, that takes position error e and velocity v to rest in h0 [s]."""
    d = r * h0 * h0
    a0 = h0 * v
    y = e + a0
    if -d <= y <= d:
        a = a0 + y
    else:
        root = sqrt(d * (d + 8.0 * abs(y)))
        a = a0 + 0.5 * (root - d) if y > 0.0 else a0 - 0.5 * (root - d)
    if -d <= a <= d:
        return -r * a / d
    return -r if a > 0.0 else r


def follow(g, x, v, state, gains, h):
    """Write the signal that tracks g to x, and its derivative to v.

    state: x and v before the next sample; changed in place. gains: r, h0 [s]. h: sampling
    period [s].
    """
    if len(x) != len(g) or len(v) != len(g) or len(state) != 2 or len(gains) != 2:
        raise ValueError("tracking: lengths differ")
    x1, x2, r, h0 = float(state[0]), float(state[1]), float(gains[0]), float(gains[1])
    for k in range(len(g)):
        u = fhan(x1 - float(g[k]), x2, r, h0)
        x1 += h * x2
        x2 += h * u
        x[k] = x1
        v[k] = x2
    state[0], state[1] = x1, x2
