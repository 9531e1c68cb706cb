"""Recursive least squares in square-root information form, by Givens rotations.

The triangle R and the vector z say all that the rows so far say of theta: |R theta - z|^2 plus
the residual is the sum of squares. No normal equations are formed, so no digits are lost, and
the covariance (R' R)^-1 is symmetric positive definite by construction. A triangle of zeros is
plain least squares; P0^(-1/2) and a forgetting factor make it recursive least squares.
"""

from math import sqrt


def update(W, y, triangle, row, sums, estimates, forgetting, floor):
    """Take the rows of W and y in, sample by sample; write theta after each to estimates.

    W (samples, joints, parameters), y (samples, joints), triangle (parameters, parameters + 1)
    holding R and z, row (parameters + 1): work space, sums: the sum of squares not explained and
    the number of rows, both forgetting, estimates (samples or 0, parameters). All but W and y are
    changed in place. forgetting: per sample. floor: see `forget`.
    """
    p = triangle.shape[0]
    samples = W.shape[0]
    joints = W.shape[1]
    if W.shape[2] != p or triangle.shape[1] != p + 1 or estimates.shape[1] != p:
        raise ValueError("information: numbers of parameters differ")
    if y.shape[0] != samples or y.shape[1] != joints or len(row) != p + 1 or len(sums) != 2:
        raise ValueError("information: numbers of samples or joints differ")
    traced = estimates.shape[0] > 0
    if traced and estimates.shape[0] != samples:
        raise ValueError("information: numbers of samples and estimates differ")
    keep = sqrt(forgetting)
    squares, weight = float(sums[0]), float(sums[1])
    for k in range(samples):
        if forgetting != 1.0:
            squares *= forgetting
            weight *= forgetting
            forget(triangle, keep, floor, p)
        for n in range(joints):
            for j in range(p):
                row[j] = float(W[k, n, j])
            row[p] = float(y[k, n])
            rotate(triangle, row, p)
            squares += float(row[p]) * float(row[p])
            weight += 1.0
        if traced:
            solve(triangle, estimates, k, p)
    sums[0], sums[1] = squares, weight


def forget(triangle, keep, floor, p):
    """Let each row of the triangle, an equation for theta, count a little less.

    A row whose diagonal would fall below the floor is kept as it is: without excitation the
    estimates stay where they are and the covariance stays bounded.
    """
    for i in range(p):
        if abs(float(triangle[i, i])) * keep >= floor:
            for j in range(i, p + 1):
                triangle[i, j] = float(triangle[i, j]) * keep


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


def solve(triangle, estimates, k, p):
    """Back substitution: R theta = z, into row k of estimates."""
    for i in range(p - 1, -1, -1):
        t = float(triangle[i, p])
        for j in range(i + 1, p):
            t -= float(triangle[i, j]) * float(estimates[k, j])
        estimates[k, i] = t / float(triangle[i, i])
