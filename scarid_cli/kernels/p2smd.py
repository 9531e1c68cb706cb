"""The paper's second-order sliding-mode differentiator with adaptive gains (equations 7 to 9)."""

from math import cbrt, sqrt


def sign(x):
    """The sign of x; 0 at 0, which does occur with a quantised input at rest."""
    if x > 0.0:
        return 1.0
    return -1.0 if x < 0.0 else 0.0


def clip(x, low, high):
    """The number in [low, high] that is nearest to x."""
    return min(max(x, low), high)


def differentiate(g, v, a, state, gains, h):
    """Write velocity y0 and acceleration y1 of each position in g to v and a, in explicit steps.

    state: [0] z0, [1] z1, [2] nu, the integral of the sign of e1 [s], [3] to [5] the adaptive gains
    eta0, eta1, eta2; changed in place. gains: Gamma0 and Gamma1 [1/s], leak [1/s], floor and cap of
    the adaptive gains, cap of |nu| [s]. h: sampling period [s].
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


def implicit(g, v, a, state, gains, h):
    """The same in implicit Euler steps; the floor of the adaptive gains must not be negative.

    Each step solves a strictly monotone equation for e = z0 - g after the step. The arguments are
    those of `differentiate`.
    """
    if len(v) != len(g) or len(a) != len(g) or len(state) != 6 or len(gains) != 6:
        raise ValueError("p2smd: lengths differ")
    z0, z1, nu = float(state[0]), float(state[1]), float(state[2])
    eta0, eta1, eta2 = float(state[3]), float(state[4]), float(state[5])
    gamma0, gamma1, keep = float(gains[0]), float(gains[1]), 1.0 - h * float(gains[2])
    floor, cap, nu_max = float(gains[3]), float(gains[4]), float(gains[5])
    for k in range(len(g)):
        b = z0 + h * z1 - h * h * eta2 * nu - float(g[k])
        dead = h * h * h * eta2
        if abs(b) <= dead:
            e0 = 0.0
            s = b / dead if dead > 0.0 else 0.0
            p0 = 0.0
        else:
            s = sign(b)
            q = root(abs(b) - dead, eta0, eta1, gamma0, gamma1, h)
            e0 = s * q * q * q
            p0 = s * q * q
        e1 = eta0 * p0 + gamma0 * e0
        p1 = sqrt(abs(e1)) * sign(e1)
        nu = clip(nu + h * s, -nu_max, nu_max)
        y1 = -eta1 * p1 - eta2 * nu - gamma1 * e1
        z1 += h * y1
        v[k] = z1 - e1
        a[k] = y1
        z0 = float(g[k]) + e0
        eta0 = clip(keep * eta0 + h * p0 * e0, floor, cap)
        eta1 = clip(keep * eta1 + h * p1 * e1, floor, cap)
        eta2 = clip(keep * eta2 + h * e1 * nu, floor, cap)
    state[0], state[1], state[2] = z0, z1, nu
    state[3], state[4], state[5] = eta0, eta1, eta2


def root(r, eta0, eta1, gamma0, gamma1, h):
    """The cube root q of |e|, by Newton's method within a bracket.

    It solves (1 + h gamma0) q^3 + h eta0 q^2 + h^2 (eta1 sqrt(f) + gamma1 f) = r with
    f = eta0 q^2 + gamma0 q^3; the left side increases with q.
    """
    low = 0.0
    high = cbrt(r / (1.0 + h * gamma0 + h * h * gamma0 * gamma1))
    q = high
    for _ in range(60):
        f = q * q * (eta0 + gamma0 * q)
        slope = q * (2.0 * eta0 + 3.0 * gamma0 * q)
        part = sqrt(f)
        value = q * q * ((1.0 + h * gamma0) * q + h * eta0) + h * h * (eta1 * part + gamma1 * f) - r
        rise = q * (3.0 * (1.0 + h * gamma0) * q + 2.0 * h * eta0) + h * h * gamma1 * slope
        if part > 0.0:
            rise += 0.5 * h * h * eta1 * slope / part
        if value > 0.0:
            high = q
        else:
            low = q
        step = value / rise if rise > 0.0 else 0.0
        old = q
        q = q - step
        if not low < q < high:
            q = 0.5 * (low + high)
        if abs(q - old) <= 1e-15 * q or high - low <= 1e-15 * high:
            break
    return q
