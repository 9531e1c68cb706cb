"""Recursive least squares in information form, by Givens rotations without square roots.

Gentleman 1973 ("Least squares computations by Givens transformations without square roots"), as in
algorithm AS 274. The unit triangle R, the weights d of its rows and the vector z contain all the
information of the rows so far about theta: the sum of squares is the sum of d (R theta - z)^2 plus
the residual. No normal equations are formed, so no digits are lost, and the covariance
(R' d R)^-1 is symmetric positive definite by construction. With initial weights of zero this is
plain least squares; with the initial information P0^-1 and a forgetting factor it is recursive
least squares.
"""

from math import sqrt


def update(W, y, scales, triangle, row, sums, estimates, forgetting, floor):
    """Take in the rows of W and y sample by sample, and write theta after each to estimates.

    W (samples, joints, parameters), y (samples, joints). scales (samples, joints): what each row is
    multiplied by; 0 leaves it out. triangle (parameters, parameters + 1): R and z, with d in place
    of the ones. row (parameters + 1): work space. sums: [0] the residual sum of squares, [1] the
    number of rows, both subject to forgetting, [2] the number of samples. estimates (samples or 0,
    parameters). All but W, y, scales and forgetting are changed in place. forgetting (parameters):
    factors per sample; the residual forgets by the first of them. floor: see `forget`.
    """
    p = triangle.shape[0]
    samples = W.shape[0]
    joints = W.shape[1]
    if W.shape[2] != p or triangle.shape[1] != p + 1 or estimates.shape[1] != p:
        raise ValueError("information: numbers of parameters differ")
    if y.shape[0] != samples or y.shape[1] != joints or len(row) != p + 1 or len(sums) != 3:
        raise ValueError("information: numbers of samples or joints differ")
    if scales.shape[0] != samples or scales.shape[1] != joints or len(forgetting) != p:
        raise ValueError("information: numbers of scales or factors differ")
    traced = estimates.shape[0] > 0
    if traced and estimates.shape[0] != samples:
        raise ValueError("information: numbers of samples and estimates differ")
    forgets = differs(forgetting, 1.0, p)
    for k in range(samples):
        if forgets:
            sums[0] = float(sums[0]) * float(forgetting[0])
            sums[1] = float(sums[1]) * float(forgetting[0])
            forget(triangle, row, forgetting, floor, int(float(sums[2])) % p, p)
        for n in range(joints):
            take(W, y, scales, triangle, row, sums, k, n, p)
        sums[2] = float(sums[2]) + 1.0
        if traced:
            solve(triangle, row, p)
            for j in range(p):
                estimates[k, j] = float(row[j])


def take(W, y, scales, triangle, row, sums, k, n, p):
    """Take in the row of joint n at sample k, times its scale."""
    scale = float(scales[k, n])
    if scale == 0.0:
        return
    for j in range(p):
        row[j] = float(W[k, n, j])
    row[p] = float(y[k, n])
    weight = rotate(triangle, row, scale * scale, p)
    sums[0] = float(sums[0]) + weight * float(row[p]) * float(row[p])
    sums[1] = float(sums[1]) + 1.0


def differs(factors, value, p):
    """Whether any factor differs from the value."""
    count = 0
    for i in range(p):
        count += float(factors[i]) != value
    return count > 0


def forget(triangle, row, forgetting, floor, turn, p):
    """Reduce the information about each parameter by its factor, without moving the estimates.

    A little information, equal to the floor in the long run, is given back to one parameter in
    turn, at its present estimate. So without excitation the covariance stays below about 1 / floor
    in every direction.
    """
    solve(triangle, row, p)
    several = differs(forgetting, float(forgetting[0]), p)
    for i in range(p):
        triangle[i, i] = float(triangle[i, i]) * float(forgetting[i])
        if several:
            tilt(triangle, row, forgetting, i, p)
    theta = float(row[turn])
    for i in range(p):
        row[i] = 0.0
    row[turn] = 1.0
    row[p] = theta
    back = floor * p * (1.0 - float(forgetting[turn]))
    if back > 0.0:
        rotate(triangle, row, back, p)


def tilt(triangle, theta, forgetting, i, p):
    """Adjust row i to factors that differ, so that the same estimates still solve it."""
    z = float(theta[i])
    for j in range(i + 1, p):
        ratio = sqrt(float(forgetting[j]) / float(forgetting[i]))
        triangle[i, j] = float(triangle[i, j]) * ratio
        z += float(triangle[i, j]) * float(theta[j])
    triangle[i, p] = z


def rotate(triangle, row, weight, p):
    """Rotate a row into the triangle; return its remaining weight, its residual being row[p]."""
    for j in range(p):
        x = float(row[j])
        if x == 0.0:
            continue
        d = float(triangle[j, j])
        pull = weight * x
        total = d + pull * x
        if total == 0.0:  # the squares underflow
            continue
        c = d / total
        s = pull / total
        triangle[j, j] = total
        weight = c * weight
        for i in range(j + 1, p + 1):
            t = float(triangle[j, i])
            u = float(row[i])
            triangle[j, i] = c * t + s * u
            row[i] = u - x * t
        if weight == 0.0:
            break
    return weight


def solve(triangle, row, p):
    """Solve R theta = z by back substitution, and write theta to the row."""
    for i in range(p):
        row[i] = float(triangle[i, p])
    for j in range(p - 1, 0, -1):
        x = float(row[j])
        for i in range(j):
            row[i] = float(row[i]) - float(triangle[i, j]) * x
