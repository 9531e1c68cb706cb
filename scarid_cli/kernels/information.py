"""Recursive least squares in square-root information form, by Givens rotations.

The triangle R and the vector z say all that the rows so far say of theta: |R theta - z|^2 plus
the residual is the sum of squares. No normal equations are formed, so no digits are lost, and
the covariance (R' R)^-1 is symmetric positive definite by construction. A triangle of zeros is
plain least squares; P0^(-1/2) and a forgetting factor make it recursive least squares.
"""

from math import sqrt


def update(W, y, scales, triangle, row, sums, estimates, keep, floor):
    """Take the rows of W and y in, sample by sample; write theta after each to estimates.

    W (samples, joints, parameters), y (samples, joints), scales (samples, joints): what each row is
    multiplied by, 0 leaves it out; triangle (parameters, parameters + 1) holding R and z, row
    (parameters + 1): work space; sums: the sum of squares not explained, the number of rows, both
    forgetting, and the samples so far; estimates (samples or 0, parameters). All but W, y, scales
    and keep are changed in place. keep (parameters): square roots of the forgetting factors per
    sample; the residual forgets like the first of them. floor: see `forget`.
    """
    p = triangle.shape[0]
    samples = W.shape[0]
    joints = W.shape[1]
    if W.shape[2] != p or triangle.shape[1] != p + 1 or estimates.shape[1] != p or len(keep) != p:
        raise ValueError("information: numbers of parameters differ")
    if y.shape[0] != samples or y.shape[1] != joints or len(row) != p + 1 or len(sums) != 3:
        raise ValueError("information: numbers of samples or joints differ")
    if scales.shape[0] != samples or scales.shape[1] != joints:
        raise ValueError("information: numbers of scales differ")
    traced = estimates.shape[0] > 0
    if traced and estimates.shape[0] != samples:
        raise ValueError("information: numbers of samples and estimates differ")
    forgets = differs(keep, 1.0, p)
    for k in range(samples):
        if forgets:
            sums[0] = float(sums[0]) * float(keep[0]) * float(keep[0])
            sums[1] = float(sums[1]) * float(keep[0]) * float(keep[0])
            forget(triangle, row, keep, floor, int(float(sums[2])) % p, p)
        for n in range(joints):
            take(W, y, scales, triangle, row, sums, k, n, p)
        sums[2] = float(sums[2]) + 1.0
        if traced:
            solve(triangle, row, p)
            for j in range(p):
                estimates[k, j] = float(row[j])


def take(W, y, scales, triangle, row, sums, k, n, p):
    """The row of joint n at sample k, times its scale."""
    scale = float(scales[k, n])
    if scale == 0.0:
        return
    for j in range(p):
        row[j] = scale * float(W[k, n, j])
    row[p] = scale * float(y[k, n])
    rotate(triangle, row, p)
    sums[0] = float(sums[0]) + float(row[p]) * float(row[p])
    sums[1] = float(sums[1]) + 1.0


def differs(keep, value, p):
    """Whether a factor is another than this."""
    count = 0
    for i in range(p):
        count += float(keep[i]) != value
    return count > 0


def forget(triangle, row, keep, floor, turn, p):
    """Let the information of each parameter count a little less; the estimates stay.

    A little information, worth floor^2 in the long run, is given back to one parameter in turn, at
    its present estimate: without excitation the covariance stays below about floor^-2, in every
    direction.
    """
    solve(triangle, row, p)
    several = differs(keep, float(keep[0]), p)
    for i in range(p):
        z = 0.0
        for j in range(i, p):
            triangle[i, j] = float(triangle[i, j]) * float(keep[j])
            z += float(triangle[i, j]) * float(row[j])
        triangle[i, p] = z if several else float(triangle[i, p]) * float(keep[0])
    back = floor * sqrt(p * (1.0 - float(keep[turn]) * float(keep[turn])))
    theta = float(row[turn])
    for i in range(p):
        row[i] = 0.0
    row[turn] = back
    row[p] = back * theta
    rotate(triangle, row, p)


def rotate(triangle, row, p):
    """Turn one row into the triangle; what is left in row[p] is its share of the residual."""
    for j in range(p):
        x = float(row[j])
        if x == 0.0:
            continue
        d = float(triangle[j, j])
        r = sqrt(d * d + x * x)
        if r == 0.0:  # both squares underflow
            continue
        c = d / r
        s = x / r
        triangle[j, j] = r
        for i in range(j + 1, p + 1):
            t = float(triangle[j, i])
            u = float(row[i])
            triangle[j, i] = c * t + s * u
            row[i] = c * u - s * t


def solve(triangle, row, p):
    """Back substitution: R theta = z, into the row."""
    for i in range(p - 1, -1, -1):
        t = float(triangle[i, p])
        for j in range(i + 1, p):
            t -= float(triangle[i, j]) * float(row[j])
        row[i] = t / float(triangle[i, i])
