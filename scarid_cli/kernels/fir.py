"""Finite impulse response filter, alone and after a backward difference (ED+FIR of the paper)."""


def filtered(x, y, line, taps):
    """Write the filtered x to y. line: the last samples, newest first; changed in place."""
    n = len(taps)
    if len(y) != len(x) or len(line) != n or n == 0:
        raise ValueError("fir: lengths differ")
    for k in range(len(x)):
        for i in range(n - 1, 0, -1):
            line[i] = line[i - 1]
        line[0] = float(x[k])
        total = 0.0
        for i in range(n):
            total += float(taps[i]) * float(line[i])
        y[k] = total


def differentiate(g, out, line, taps, h):
    """Write the filtered backward difference of g to out.

    line: the last differences, newest first, then the last sample; changed in place. h [s].
    """
    if len(out) != len(g) or len(line) != len(taps) + 1 or len(taps) == 0:
        raise ValueError("fir: lengths differ")
    n = len(taps)
    last = float(line[n])
    for k in range(len(g)):
        x = float(g[k])
        for i in range(n - 1, 0, -1):
            line[i] = line[i - 1]
        line[0] = (x - last) / h
        last = x
        y = 0.0
        for i in range(n):
            y += float(taps[i]) * float(line[i])
        out[k] = y
    line[n] = last
