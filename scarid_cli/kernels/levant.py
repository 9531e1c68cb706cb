"""Levant's sliding-mode differentiator of arbitrary order in explicit steps, filtering or not."""

from math import pow  # noqa: A004 (on floats alone)


def sign(x):
    """The sign of x; 0 at 0."""
    if x > 0.0:
        return 1.0
    return -1.0 if x < 0.0 else 0.0


def differentiate(g, v, a, state, gains, filters, taylor, h):
    """Write the velocity and the acceleration of each position in g to v and a.

    For order 1 there is no acceleration. state: `filters` filter states, then z0, z1, ...; changed
    in place. gains: lambda_i L^((i+1)/(N+1)), one for each of the N + 1 states. taylor: 0 for Euler
    steps; 1 adds the terms of second and higher order (homogeneous discrete differentiator). h:
    sampling period [s]. The states after an update belong to the next sample; the Taylor series
    brings them back to the present one.
    """
    last = len(state) - 1
    if len(v) != len(g) or len(a) != len(g) or len(gains) != len(state):
        raise ValueError("levant: lengths differ")
    if not 0 <= filters < last:
        raise ValueError("levant: wrong numbers of states")
    for k in range(len(g)):
        e = float(state[filters]) - float(g[k])
        x = float(state[0]) if filters > 0 else e
        s = sign(x)
        root = pow(abs(x), 1.0 / (last + 1))
        for i in range(last + 1):
            power = s
            for _ in range(last - i):
                power *= root
            rate = -float(gains[i]) * power
            if i == filters - 1:
                rate += e
            elif i < last:
                rate += float(state[i + 1])
            state[i] += h * rate
            if taylor and i >= filters:
                step = h
                for j in range(2, last - i + 1):
                    step *= h / j
                    state[i] += step * float(state[i + j])
        v[k] = back(state, filters + 1, h)
        a[k] = back(state, filters + 2, h)


def back(z, first, h):
    """The state z[first] one period earlier."""
    value = 0.0
    step = 1.0
    for j in range(len(z) - first):
        value += step * float(z[first + j])
        step *= -h / (j + 1)
    return value
