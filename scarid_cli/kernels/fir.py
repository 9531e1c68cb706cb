"""Filter of finite impulse response."""


def filtered(x, y, taps):
    """Write the filtered x to y: with n taps, y[k] is the sum of taps[i] x[k + n - 1 - i].

    x: the n - 1 samples before the first of y, then one for each of y. Four taps at a time are
    applied to all of y, so that neighbours can be computed together.
    """
    n = len(taps)
    rows = len(y)
    if n == 0 or len(x) != rows + n - 1:
        raise ValueError("fir: lengths differ")
    whole = n - n % 4
    for k in range(rows):
        y[k] = 0.0
    for i in range(0, whole, 4):
        a, b, c, d = float(taps[i]), float(taps[i + 1]), float(taps[i + 2]), float(taps[i + 3])
        first = n - 1 - i
        for k in range(rows):
            newer = a * float(x[first + k]) + b * float(x[first + k - 1])
            older = c * float(x[first + k - 2]) + d * float(x[first + k - 3])
            y[k] = float(y[k]) + (newer + older)
    for i in range(whole, n):
        a = float(taps[i])
        first = n - 1 - i
        for k in range(rows):
            y[k] = float(y[k]) + a * float(x[first + k])
