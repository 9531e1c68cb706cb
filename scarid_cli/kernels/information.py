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

LEAST = 1e-6  # of the largest deviation of a residual


def update(W, y, scales, triangle, row, sums, estimates, forgetting, floor, residuals, apart):
    """Take in the rows of W and y sample by sample, and write theta after each to estimates.

    W (samples, joints, parameters), y (samples, joints). scales (samples, joints): what each row is
    multiplied by; 0 leaves it out. triangle (parameters, parameters + 1): R and z, with d in place
    of the ones. row (parameters + 1): work space. sums: [0] the residual sum of squares, [1] the
    number of rows, both subject to forgetting, [2] the number of samples. estimates (samples or 0,
    parameters). All but W, y, scales and forgetting are changed in place. forgetting (parameters):
    factors per sample; the residual forgets by the first of them. floor: see `forget`. residuals
    (joints or 0, 4): if not empty, rows are weighted by the running residual of their joint, see
    `weigh`; changed in place. apart: the number of rows for each that is independent.
    """
    p = triangle.shape[0]
    samples = W.shape[0]
    joints = W.shape[1]
    check(W, y, scales, triangle, row, sums, estimates, forgetting, residuals)
    weighs = residuals.shape[0] > 0
    traced = estimates.shape[0] > 0
    forgets = differs(forgetting, 1.0, p)
    for k in range(samples):
        if forgets:
            sums[0] = float(sums[0]) * float(forgetting[0])
            sums[1] = float(sums[1]) * float(forgetting[0])
            forget(triangle, row, forgetting, floor, int(float(sums[2])) % p, p)
        if weighs:
            weigh(residuals, joints, apart * p, apart)
        for n in range(joints):
            take(W, y, scales, triangle, row, sums, residuals, float(forgetting[0]), k, n, p)
        sums[2] = float(sums[2]) + 1.0
        if traced:
            solve(triangle, row, p)
            for j in range(p):
                estimates[k, j] = float(row[j])


def check(W, y, scales, triangle, row, sums, estimates, forgetting, residuals):
    """Refuse arrays whose sizes do not fit each other."""
    p = triangle.shape[0]
    n = W.shape[0]
    if W.shape[2] != p or triangle.shape[1] != p + 1 or estimates.shape[1] != p:
        raise ValueError("information: numbers of parameters differ")
    if y.shape[0] != n or y.shape[1] != W.shape[1] or len(row) != p + 1 or len(sums) != 3:
        raise ValueError("information: numbers of samples or joints differ")
    if scales.shape[0] != n or scales.shape[1] != W.shape[1] or len(forgetting) != p:
        raise ValueError("information: numbers of scales or factors differ")
    if estimates.shape[0] != 0 and estimates.shape[0] != n:
        raise ValueError("information: numbers of samples and estimates differ")
    if residuals.shape[1] != 4 or (residuals.shape[0] != 0 and residuals.shape[0] != W.shape[1]):
        raise ValueError("information: numbers of joints and residuals differ")


def take(W, y, scales, triangle, row, sums, residuals, forgetting, k, n, p):
    """Take in the row of joint n at sample k, times its scale and the weight of the joint."""
    scale = float(scales[k, n])
    if scale == 0.0:
        return
    weighs = residuals.shape[0] > 0
    if weighs:
        scale *= float(residuals[n, 3])
    for j in range(p):
        row[j] = float(W[k, n, j])
    row[p] = float(y[k, n])
    weight = rotate(triangle, row, scale * scale, p)
    square = weight * float(row[p]) * float(row[p])
    sums[0] = float(sums[0]) + square
    sums[1] = float(sums[1]) + 1.0
    tau = float(y[k, n])
    if weighs and tau != 0.0:
        residuals[n, 0] = float(residuals[n, 0]) * forgetting + square / (scale * scale)
        residuals[n, 1] = float(residuals[n, 1]) * forgetting + 1.0
        residuals[n, 2] = float(residuals[n, 2]) * forgetting + tau * tau


def weigh(residuals, joints, needed, apart):
    """Write the weight of each joint: the largest deviation of a residual over that of the joint.

    residuals (joints, 4): [0] the sum of squares of the recursive residuals so far (Brown, Durbin
    and Evans 1975: each is what its row leaves of the fit of the rows before it, over the square
    root of 1 + x' P x), [1] the number of rows, [2] the sum of squares of the torques, all subject
    to forgetting and without rows whose torque is 0, [3] the weight. The residual of n rows counts
    as at least the share needed / n of the torque, because fewer rows than needed are fitted
    anyhow. A joint with fewer rows with a torque than are one independent row, the number apart,
    weighs as much as the least certain one, and no joint outweighs another by more than a factor
    of a million.
    """
    largest = 0.0
    for n in range(joints):
        largest = max(largest, variance(residuals, n, needed, apart))
    for n in range(joints):
        own = variance(residuals, n, needed, apart)
        least = LEAST * LEAST * largest
        residuals[n, 3] = sqrt(largest / max(own, least)) if own > 0.0 else 1.0


def variance(residuals, n, needed, apart):
    """The variance of the residual of joint n; 0 before its first independent row."""
    rows = float(residuals[n, 1])
    if rows < apart:
        return 0.0
    share = needed / rows
    return (float(residuals[n, 0]) + share * share * float(residuals[n, 2])) / rows


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
