"""Levant's second-order sliding-mode differentiator in explicit Euler steps (paper, equation 6)."""

from math import cbrt, sqrt


def sign(x):
    """The sign of x; 0 at 0."""
    if x > 0.0:
        return 1.0
    return -1.0 if x < 0.0 else 0.0


def differentiate(g, v, a, state, gains, h):
    """Write the velocity and the acceleration of each position in g to v and a.

    The states after an update belong to the next sample; v = z1 - h z2 and a = z2 bring them
    back to the present one. state: z0, z1, z2; changed in place. gains: eta0, eta1, eta2. h:
    sampling period [s].
    """
    if len(v) != len(g) or len(a) != len(g) or len(state) != 3 or len(gains) != 3:
        raise ValueError("2smd: lengths differ")
    z0, z1, z2 = float(state[0]), float(state[1]), float(state[2])
    eta0, eta1, eta2 = float(gains[0]), float(gains[1]), float(gains[2])
    for k in range(len(g)):
        e0 = z0 - float(g[k])
        root = cbrt(e0)
        y0 = z1 - eta0 * root * root * sign(e0)
        e1 = z1 - y0
        s1 = sign(e1)
        y1 = z2 - eta1 * sqrt(abs(e1)) * s1
        z0 += h * y0
        z1 += h * y1
        z2 -= h * eta2 * s1
        v[k] = z1 - h * z2
        a[k] = z2
    state[0], state[1], state[2] = z0, z1, z2
