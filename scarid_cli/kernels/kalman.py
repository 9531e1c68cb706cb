"""Kalman filter of a scalar measurement, whose gain becomes constant, and its smoothers.

SETTLED: the relative change of the gain from one sample to the next below which it is kept.
PATIENCE: how many innovations in a row may be taken for glitches. MEMORY: the rate per sample at
which the usual mean square of the innovations follows the present one.
"""

from math import log

SETTLED = 1e-11
PATIENCE = 3.0
MEMORY = 0.02


def filtered(g, estimates, x, P, gain, work, F, Q, noise):
    """Write the filtered state (m) for each measurement in g to a row of estimates.

    x (m), P (m, m): the predicted state and its covariance. gain (m): the last gain. F, Q (m, m):
    the model. noise: [0] the variance of g, [1] the square of the number of standard deviations
    beyond which an innovation is a glitch and left out. work: [0] the log-likelihood so far, [1] 1
    once the gain is constant, 2 if it is kept at glitches as well, [2] the number of glitches in a
    row, [3] the logarithm of the variance of the innovation, [4] the usual mean square of the
    innovation, [5] and following: work space for m (m + 1) numbers. x, P, gain and work are changed
    in place.
    """
    m = len(x)
    check(m, P, gain, work, F, Q, noise)
    if len(estimates) != len(g) or estimates.shape[1] != m:
        raise ValueError("kalman: lengths differ")
    for k in range(len(g)):
        update(float(g[k]), x, P, gain, work, float(noise[0]), float(noise[1]), m)
        for i in range(m):
            estimates[k, i] = x[i]
        predict(x, P, work, F, Q, m)


def recorded(
    g, predictions, innovations, steady, gains, covariances, x, P, gain, work, F, Q, noise
):
    """Filter, and write what the smoothers need of each row.

    predictions (rows, m): of the state. innovations (rows): over their variance, 0 at a glitch.
    steady (rows): 1 where the gain is constant, 0 at a glitch. gains (rows, m): 0 at a glitch.
    covariances (rows, m, m): of the predictions, written only where not steady. The other
    arguments are those of `filtered`.
    """
    m = len(x)
    n = len(g)
    check(m, P, gain, work, F, Q, noise)
    check_records(n, m, predictions, innovations, steady, gains, covariances)
    for k in range(n):
        settled = float(work[1])
        for i in range(m):
            predictions[k, i] = x[i]
        if settled == 0.0:
            keep(covariances, P, k, m)
        u = (float(g[k]) - float(x[0])) / (float(P[0, 0]) + float(noise[0]))
        if update(float(g[k]), x, P, gain, work, float(noise[0]), float(noise[1]), m):
            innovations[k] = u
            steady[k] = settled
            for i in range(m):
                gains[k, i] = gain[i]
        else:
            innovations[k] = 0.0
            steady[k] = 0.0
            for i in range(m):
                gains[k, i] = 0.0
            if settled != 0.0:
                keep(covariances, P, k, m)
        predict(x, P, work, F, Q, m)


def keep(covariances, P, k, m):
    """Write the covariance P to row k of the covariances."""
    for i in range(m):
        for j in range(m):
            covariances[k, i, j] = P[i, j]


def check(m, P, gain, work, F, Q, noise):
    """Refuse arrays that do not fit a state of m numbers."""
    square = P.shape[0] == m and P.shape[1] == m and F.shape[0] == m and F.shape[1] == m
    if not square or Q.shape[0] != m or Q.shape[1] != m or len(gain) != m:
        raise ValueError("kalman: sizes differ")
    if m == 0 or len(work) != 5 + m * (m + 1) or len(noise) != 2:
        raise ValueError("kalman: lengths differ")


def check_records(n, m, predictions, innovations, steady, gains, covariances):
    """Refuse records that are not of n rows and m states."""
    if len(predictions) != n or len(innovations) != n or len(steady) != n:
        raise ValueError("kalman: lengths differ")
    if len(gains) != n or len(covariances) != n:
        raise ValueError("kalman: lengths differ")
    if predictions.shape[1] != m or gains.shape[1] != m:
        raise ValueError("kalman: sizes differ")
    if covariances.shape[1] != m or covariances.shape[2] != m:
        raise ValueError("kalman: sizes differ")


def update(g, x, P, gain, work, r, gate, m):
    """Update the state by a measurement; return False if it was left out as a glitch."""
    e = g - float(x[0])
    s = float(P[0, 0]) + r
    if float(work[1]) == 0.0:
        work[1] = settle(P, gain, s, m)
        work[3] = log(s)
    if glitch(e, s, work, gate):
        if float(work[1]) == 1.0:  # without a measurement the covariance grows, and the gain too
            work[1] = 0.0
        return False
    work[0] -= 0.5 * (float(work[3]) + e * e / s)
    for i in range(m):
        x[i] += float(gain[i]) * e
    if float(work[1]) == 0.0:
        for i in range(m):
            for j in range(m):
                P[i, j] -= float(gain[i]) * float(gain[j]) * s
    return True


def settle(P, gain, s, m):
    """Write the gain for the covariance P; return 1 if it has not changed."""
    still = 1.0
    for i in range(m):
        old = float(gain[i])
        gain[i] = float(P[i, 0]) / s
        if abs(float(gain[i]) - old) > SETTLED * abs(float(gain[i])):
            still = 0.0
    return still


def glitch(e, s, work, gate):
    """Whether an innovation e of variance s is a glitch.

    It is compared with the usual mean square of the innovations, for a model may be wrong about s.
    What lasts longer than a glitch is a motion that the model did not expect: then all measurements
    are taken in until the innovation is small again.
    """
    usual = max(s, float(work[4]))
    work[4] += MEMORY * (min(e * e, gate * usual) - float(work[4]))
    if e * e <= gate * usual:
        work[2] = 0.0
        return False
    if float(work[2]) >= PATIENCE:
        return False
    work[2] += 1.0
    work[0] -= 0.5 * (float(work[3]) + gate * usual / s)
    return True


def predict(x, P, work, F, Q, m):
    """Predict the next sample: x = F x, and unless the gain is constant P = F P F' + Q."""
    for i in range(m):
        total = 0.0
        for j in range(m):
            total += float(F[i, j]) * float(x[j])
        work[5 + i] = total
    for i in range(m):
        x[i] = work[5 + i]
    if float(work[1]) == 0.0:
        spread(P, work, F, Q, m)


def spread(P, work, F, Q, m):
    """Write F P F' + Q to P."""
    room = 5 + m
    for i in range(m):
        for j in range(m):
            total = 0.0
            for n in range(m):
                total += float(F[i, n]) * float(P[n, j])
            work[room + i * m + j] = total
    for i in range(m):
        for j in range(i + 1):
            total = float(Q[i, j])
            for n in range(m):
                total += float(work[room + i * m + n]) * float(F[j, n])
            P[i, j] = total
            P[j, i] = total


def lagged(predictions, innovations, steady, gains, covariances, P, F, weights, out, r):
    """Write velocity and acceleration to rows of out, each from its own row and the d after it.

    The last rows have fewer rows after them. out may have fewer rows than there are records.
    weights (2, d + 1): what each innovation, that of the row itself first, adds to velocity and
    acceleration once the gain is constant. P: the covariance where steady. r: work space for 2 m
    numbers.
    """
    n = len(predictions)
    m = F.shape[0]
    d = weights.shape[1] - 1
    check_records(n, m, predictions, innovations, steady, gains, covariances)
    if len(out) > n or out.shape[1] != 2 or len(weights) != 2 or d < 0 or m < 3:
        raise ValueError("kalman: lengths differ")
    if F.shape[1] != m or P.shape[0] != m or P.shape[1] != m or len(r) != 2 * m:
        raise ValueError("kalman: sizes differ")
    unsettled = -1
    seen = 0
    for k in range(len(out)):
        while seen < n and seen <= k + d:
            if float(steady[seen]) == 0.0:
                unsettled = seen
            seen += 1
        if unsettled < k and k + d < n:
            out[k, 0] = float(predictions[k, 1]) + weighed(weights, innovations, 0, k, d)
            out[k, 1] = float(predictions[k, 2]) + weighed(weights, innovations, 1, k, d)
            continue
        for i in range(m):
            r[i] = 0.0
        for j in range(min(k + d, n - 1), k - 1, -1):
            back(innovations, gains, F, r, j, m)
        out[k, 0] = corrected(predictions, covariances, steady, P, r, k, 1, m)
        out[k, 1] = corrected(predictions, covariances, steady, P, r, k, 2, m)


def weighed(weights, innovations, row, k, d):
    """The weighted sum of d + 1 innovations from row k on, as four independent partial sums."""
    n = d + 1
    whole = n - n % 4
    s0 = s1 = s2 = s3 = 0.0
    for j in range(0, whole, 4):
        s0 += float(weights[row, j]) * float(innovations[k + j])
        s1 += float(weights[row, j + 1]) * float(innovations[k + j + 1])
        s2 += float(weights[row, j + 2]) * float(innovations[k + j + 2])
        s3 += float(weights[row, j + 3]) * float(innovations[k + j + 3])
    for j in range(whole, n):
        s0 += float(weights[row, j]) * float(innovations[k + j])
    return (s0 + s1) + (s2 + s3)


def smoothed(predictions, innovations, steady, gains, covariances, P, F, out, r):
    """Write position, velocity and acceleration of each row to out, from the whole record.

    The arguments are those of `lagged`.
    """
    n = len(predictions)
    m = F.shape[0]
    check_records(n, m, predictions, innovations, steady, gains, covariances)
    if len(out) != n or out.shape[1] != 3 or m < 3:
        raise ValueError("kalman: lengths differ")
    if F.shape[1] != m or P.shape[0] != m or P.shape[1] != m or len(r) != 2 * m:
        raise ValueError("kalman: sizes differ")
    for i in range(m):
        r[i] = 0.0
    for k in range(n - 1, -1, -1):
        back(innovations, gains, F, r, k, m)
        for i in range(3):
            out[k, i] = corrected(predictions, covariances, steady, P, r, k, i, m)


def back(innovations, gains, F, r, k, m):
    """The backward step r = H' u + (F (I - K H))' r at row k (Durbin and Koopman, section 4.4)."""
    along = 0.0
    for i in range(m):
        total = 0.0
        for j in range(m):
            total += float(F[j, i]) * float(r[j])
        r[m + i] = total
        along += float(gains[k, i]) * total
    for i in range(m):
        r[i] = r[m + i]
    r[0] += float(innovations[k]) - along


def corrected(predictions, covariances, steady, P, r, k, i, m):
    """State i of row k: the prediction, corrected by the samples after it."""
    total = float(predictions[k, i])
    if float(steady[k]) != 0.0:
        for j in range(m):
            total += float(P[i, j]) * float(r[j])
    else:
        for j in range(m):
            total += float(covariances[k, i, j]) * float(r[j])
    return total
