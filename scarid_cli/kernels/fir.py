"""Finite impulse response filter."""


def filtered(x, y, taps):
    """Write the filtered x to y: y[k] is the sum of taps[i] x[k + n - 1 - i], n taps.

    x: the n - 1 samples before the first of y, then one for each of y. Four partial sums, because
    one would wait for itself.
    """
    n = len(taps)
    if n == 0 or len(x) != len(y) + n - 1:
        raise ValueError("fir: lengths differ")
    whole = n - n % 4
    for k in range(len(y)):
        newest = k + n - 1
        s0 = s1 = s2 = s3 = 0.0
        for i in range(0, whole, 4):
            s0 += float(taps[i]) * float(x[newest - i])
            s1 += float(taps[i + 1]) * float(x[newest - i - 1])
            s2 += float(taps[i + 2]) * float(x[newest - i - 2])
            s3 += float(taps[i + 3]) * float(x[newest - i - 3])
        for i in range(whole, n):
            s0 += float(taps[i]) * float(x[newest - i])
        y[k] = (s0 + s1) + (s2 + s3)
