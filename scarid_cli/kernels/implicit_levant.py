"""Sliding-mode differentiator of arbitrary order in implicit steps (Mojallizadeh et al. 2021)."""

from math import pow  # noqa: A004 (on floats alone)


def differentiate(g, v, a, state, gains, h):
    """Write the velocity and the acceleration of each position in g to v and a.

    state: z0 ... zn, n from 2 to 5; changed in place. gains: lambda_i L^((i+1)/(n+1)) for i = 0
    ... n. h: sampling period [s].
    """
    n = len(state) - 1
    if len(v) != len(g) or len(a) != len(g) or len(gains) != len(state) or not 2 <= n <= 5:
        raise ValueError("implicit levant: lengths differ")
    dead = float(gains[n])
    for _ in range(n + 1):
        dead *= h
    for k in range(len(g)):
        b = float(state[n])
        for i in range(n - 1, -1, -1):
            b = float(state[i]) + h * b
        b -= float(g[k])
        if abs(b) <= dead:
            s = b / dead
            q = 0.0
        else:
            s = 1.0 if b > 0.0 else -1.0
            q = root(abs(b) - dead, gains, n, h)
        power = s
        for i in range(n, -1, -1):
            rate = -float(gains[i]) * power
            if i < n:
                rate += float(state[i + 1])
            state[i] += h * rate
            power *= q
        v[k] = velocity(state, n, h)
        a[k] = acceleration(state, n, h)


def root(r, gains, n, h):
    """The q > 0 with q^(n+1) + h gains[0] q^n + ... + h^n gains[n-1] q = r, by Newton's method.

    The polynomial is convex, so the iterates decrease to the root from above.
    """
    q = pow(r, 1.0 / (n + 1))
    for _ in range(60):
        value = 1.0
        slope = 0.0
        scale = 1.0
        for i in range(n + 1):
            slope = slope * q + value
            value *= q
            if i < n:
                scale *= h
                value += scale * float(gains[i])
        step = (value - r) / slope
        q -= step
        if step <= 1e-15 * q:
            break
    return q


def velocity(z, n, h):
    """The velocity -ln(1 - D) / h, for the states z_i are backward differences D^i / h^i."""
    value = float(z[1])
    step = 1.0
    for i in range(2, n + 1):
        step *= h
        value += step / i * float(z[i])
    return value


def acceleration(z, n, h):
    """The acceleration (-ln(1 - D))^2 / h^2 of the same backward differences D."""
    value = float(z[2])
    if n > 2:
        value += h * float(z[3])
    if n > 3:
        value += 11.0 / 12.0 * h * h * float(z[4])
    if n > 4:
        value += 5.0 / 6.0 * h * h * h * float(z[5])
    return value
