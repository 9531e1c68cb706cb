"""Adaptive super-twisting differentiator in explicit Euler steps (paper, equations 30 and 31)."""

from math import sqrt


def sign(x):
    """The sign of x; 0 at 0."""
    if x > 0.0:
        return 1.0
    return -1.0 if x < 0.0 else 0.0


def differentiate(g, out, state, gains, h):
    """Write the derivative of the samples g to out: z1 of one block after its update.

    state: z0, z1, k0; changed in place. gains: epsilon, growth = alpha1 sqrt(mu1 / 2), alpha0,
    gamma, k0m. h: sampling period [s].
    """
    if len(out) != len(g) or len(state) != 3 or len(gains) != 5:
        raise ValueError("astd: lengths differ")
    z0, z1, k0 = float(state[0]), float(state[1]), float(state[2])
    epsilon, growth, alpha0 = float(gains[0]), float(gains[1]), float(gains[2])
    gamma, k0m = float(gains[3]), float(gains[4])
    for k in range(len(g)):
        e = z0 - float(g[k])
        s = sign(e)
        y0 = z1 - k0 * sqrt(abs(e)) * s
        z0 += h * y0
        z1 -= h * epsilon * k0 * s
        out[k] = z1
        if k0 > k0m:
            k0 += h * growth * sign(abs(e) - gamma)
        else:
            k0 += h * alpha0
    state[0], state[1], state[2] = z0, z1, k0
