"""Proposed second-order sliding mode differentiator (paper eq. 7-9), explicit Euler."""

from math import cbrt, sqrt


def sign(x):
    """The sign of x, 0 at 0: with a quantised input at rest equality does happen."""
    if x > 0.0:
        return 1.0
    return -1.0 if x < 0.0 else 0.0


def clip(x, low, high):
    """The nearest number to x in [low, high]."""
    return min(max(x, low), high)


def differentiate(g, v, a, state, gains, h):
    """Write velocity y0 to v and acceleration y1 to a for each position in g.

    state: z0, z1, nu (the integral of sign e1), eta0, eta1, eta2; changed in place.
    gains: Gamma0, Gamma1 [1/s], leak [1/s], floor and cap of eta, cap of |nu| [s]. h [s].
    """
    if len(v) != len(g) or len(a) != len(g) or len(state) != 6 or len(gains) != 6:
        raise ValueError("p2smd: lengths differ")
    z0, z1, nu = float(state[0]), float(state[1]), float(state[2])
    eta0, eta1, eta2 = float(state[3]), float(state[4]), float(state[5])
    gamma0, gamma1, keep = float(gains[0]), float(gains[1]), 1.0 - h * float(gains[2])
    floor, cap, nu_max = float(gains[3]), float(gains[4]), float(gains[5])
    for k in range(len(g)):
        e0 = z0 - float(g[k])
        root = cbrt(e0)
        p0 = root * root * sign(e0)
        y0 = z1 - eta0 * p0 - gamma0 * e0
        e1 = z1 - y0
        s1 = sign(e1)
        p1 = sqrt(abs(e1)) * s1
        y1 = -eta1 * p1 - eta2 * nu - gamma1 * e1
        v[k] = y0
        a[k] = y1
        z0 += h * y0
        z1 += h * y1
        eta0 = clip(keep * eta0 + h * p0 * e0, floor, cap)
        eta1 = clip(keep * eta1 + h * p1 * e1, floor, cap)
        eta2 = clip(keep * eta2 + h * e1 * nu, floor, cap)
        nu = clip(nu + h * s1, -nu_max, nu_max)
    state[0], state[1], state[2] = z0, z1, nu
    state[3], state[4], state[5] = eta0, eta1, eta2
