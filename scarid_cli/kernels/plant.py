"""Two-joint planar mechanism in closed loop: PD(+I) control, Runge-Kutta integration in between.

The dynamics are equations 26 and 27 of the paper, corrected; a single axis is the same mechanism
with a second joint that nothing moves. Coulomb friction sticks: a joint at rest stays there as long
as the torque that would hold it is within the Coulomb friction, and a joint whose velocity changes
sign within a substep stops first.
"""

from math import cos, floor, sin


def sign(x):
    """The sign of x; 0 at 0."""
    if x > 0.0:
        return 1.0
    return -1.0 if x < 0.0 else 0.0


def quantised(x, resolution):
    """The reading of the encoder: the nearest multiple of its resolution (0: perfect)."""
    if resolution > 0.0:
        return floor(x / resolution + 0.5) * resolution
    return x


def eccentric(q, amplitude, turns, phase):
    """The position that an eccentric encoder sees: q + amplitude sin(turns q + phase)."""
    if amplitude != 0.0:
        return q + amplitude * sin(turns * q + phase)
    return q


def clip(x, limit):
    """x, limited to plus and minus limit."""
    return min(max(x, -limit), limit)


def inertia(model, q2):
    """The elements M11, M12, M22 of the inertia matrix, and the factor of its Coriolis terms."""
    c = cos(q2)
    s = sin(q2)
    coupling = float(model[2]) * c - float(model[3]) * s
    bend = float(model[2]) * s + float(model[3]) * c
    m22 = float(model[1])
    return float(model[0]) + m22 + 2.0 * coupling, m22 + coupling, m22, bend


def accelerations(model, q2, v1, v2, tau1, tau2, s1, s2):
    """The accelerations of both joints; 0 for a joint that sticks.

    model: [0] ZZ1R, [1] ZZ2, [2] L1MX2, [3] L1MY2, then of joints 1 and 2 [4, 5] the viscous
    friction, [6, 7] the Coulomb friction and [8, 9] the offset torque. s1, s2: the directions of
    sliding, 0 for a joint that sticks.
    """
    m11, m12, m22, bend = inertia(model, q2)
    r1 = tau1 + bend * v2 * (2.0 * v1 + v2)
    r1 -= float(model[4]) * v1 + float(model[6]) * s1 + float(model[8])
    r2 = tau2 - bend * v1 * v1
    r2 -= float(model[5]) * v2 + float(model[7]) * s2 + float(model[9])
    if s1 != 0.0 and s2 != 0.0:
        d = m11 * m22 - m12 * m12
        return (m22 * r1 - m12 * r2) / d, (m11 * r2 - m12 * r1) / d
    if s1 != 0.0:
        return r1 / m11, 0.0
    if s2 != 0.0:
        return 0.0, r2 / m22
    return 0.0, 0.0


def holding(model, q2, v1, v2, tau1, tau2, a1, a2):
    """The Coulomb friction torques that would explain the accelerations a1, a2."""
    m11, m12, m22, bend = inertia(model, q2)
    f1 = tau1 + bend * v2 * (2.0 * v1 + v2) - m11 * a1 - m12 * a2
    f1 -= float(model[4]) * v1 + float(model[8])
    f2 = tau2 - bend * v1 * v1 - m12 * a1 - m22 * a2
    f2 -= float(model[5]) * v2 + float(model[9])
    return f1, f2


def trial(i):
    """What a joint at rest may do: stick (i = 0), or slide forwards or backwards (i = 1, 2)."""
    return 0.0 if i == 0 else 3.0 - 2.0 * i


def suits(v, s, a, f, dry):
    """Whether a direction is consistent with the motion.

    A joint that sticks (s = 0) must be held by a torque f within the Coulomb friction `dry`; one
    that slides must accelerate in its direction.
    """
    if v != 0.0:
        return True
    if s == 0.0:
        return abs(f) <= dry
    return a * s > 0.0


def contact(model, q2, v1, v2, tau1, tau2):
    """The directions s1, s2 of sliding: each 1, -1, or 0 for a joint that sticks.

    A joint that moves slides in the direction of its velocity. For a joint at rest all three are
    tried: of all combinations of sticking and sliding, one is consistent.
    """
    if v1 != 0.0 and v2 != 0.0:
        return sign(v1), sign(v2)
    for i in range(3):
        s1 = sign(v1) if v1 != 0.0 else trial(i)
        for j in range(3):
            s2 = sign(v2) if v2 != 0.0 else trial(j)
            a1, a2 = accelerations(model, q2, v1, v2, tau1, tau2, s1, s2)
            f1, f2 = holding(model, q2, v1, v2, tau1, tau2, a1, a2)
            if suits(v1, s1, a1, f1, float(model[6])) and suits(v2, s2, a2, f2, float(model[7])):
                return s1, s2
    return sign(v1), sign(v2)


def run(reference, noise, log, state, model, control, h, substeps):
    """Run the loop over the control ticks; return the number of ticks run before it diverged.

    reference (ticks, 4): q1, q2, dq1, dq2 wanted. noise (ticks, 2): added to the positions that the
    encoders see. log (ticks, 10): measured q, torque, true q, dq and ddq, each of joints 1 and 2,
    at the tick and with its torque. state (10): q, dq, last readings, velocity estimates and
    integrals, each of joints 1 and 2; changed in place. control (17): Kp, Kd, Ki, torque limits and
    encoder resolutions, each of joints 1 and 2, then the smoothing of the velocity estimate per
    tick (0: none), then the amplitude, turns and phase of the eccentricity of the encoders, each of
    joints 1 and 2. model: see `accelerations`. h: period of the control [s].
    """
    if log.shape[0] != len(reference) or len(noise) != len(reference):
        raise ValueError("plant: lengths differ")
    if reference.shape[1] != 4 or noise.shape[1] != 2 or log.shape[1] != 10:
        raise ValueError("plant: numbers of columns are wrong")
    if len(state) != 10 or len(model) != 10 or len(control) != 17:
        raise ValueError("plant: sizes of state, model or control are wrong")
    q1, q2, v1, v2 = float(state[0]), float(state[1]), float(state[2]), float(state[3])
    last1, last2, w1, w2 = float(state[4]), float(state[5]), float(state[6]), float(state[7])
    i1, i2 = float(state[8]), float(state[9])
    smooth = float(control[10])
    d = h / substeps
    for k in range(len(reference)):
        m1 = eccentric(q1, float(control[11]), float(control[13]), float(control[15]))
        m1 = quantised(m1 + float(noise[k, 0]), float(control[8]))
        m2 = eccentric(q2, float(control[12]), float(control[14]), float(control[16]))
        m2 = quantised(m2 + float(noise[k, 1]), float(control[9]))
        w1 = smooth * w1 + (1.0 - smooth) * (m1 - last1) / h
        w2 = smooth * w2 + (1.0 - smooth) * (m2 - last2) / h
        last1 = m1
        last2 = m2
        e1 = float(reference[k, 0]) - m1
        e2 = float(reference[k, 1]) - m2
        i1 += h * float(control[4]) * e1
        i2 += h * float(control[5]) * e2
        tau1 = float(control[0]) * e1 + float(control[2]) * (float(reference[k, 2]) - w1) + i1
        tau2 = float(control[1]) * e2 + float(control[3]) * (float(reference[k, 3]) - w2) + i2
        tau1 = clip(tau1, float(control[6]))
        tau2 = clip(tau2, float(control[7]))
        for n in range(substeps):
            s1, s2 = contact(model, q2, v1, v2, tau1, tau2)
            a1, a2 = accelerations(model, q2, v1, v2, tau1, tau2, s1, s2)
            if n == 0:
                log[k, 0], log[k, 1], log[k, 2], log[k, 3] = m1, m2, tau1, tau2
                log[k, 4], log[k, 5], log[k, 6], log[k, 7] = q1, q2, v1, v2
                log[k, 8], log[k, 9] = a1, a2
            u1 = v1 + 0.5 * d * a1
            u2 = v2 + 0.5 * d * a2
            b1, b2 = accelerations(model, q2 + 0.5 * d * v2, u1, u2, tau1, tau2, s1, s2)
            x1 = v1 + 0.5 * d * b1
            x2 = v2 + 0.5 * d * b2
            c1, c2 = accelerations(model, q2 + 0.5 * d * u2, x1, x2, tau1, tau2, s1, s2)
            y1 = v1 + d * c1
            y2 = v2 + d * c2
            d1, d2 = accelerations(model, q2 + d * x2, y1, y2, tau1, tau2, s1, s2)
            q1 += d / 6.0 * (v1 + 2.0 * u1 + 2.0 * x1 + y1)
            q2 += d / 6.0 * (v2 + 2.0 * u2 + 2.0 * x2 + y2)
            v1 += d / 6.0 * (a1 + 2.0 * b1 + 2.0 * c1 + d1)
            v2 += d / 6.0 * (a2 + 2.0 * b2 + 2.0 * c2 + d2)
            if v1 * s1 < 0.0 < float(model[6]):
                v1 = 0.0
            if v2 * s2 < 0.0 < float(model[7]):
                v2 = 0.0
        if not (abs(q1) < 1e6 and abs(q2) < 1e6 and abs(v1) < 1e6 and abs(v2) < 1e6):
            return k
    state[0], state[1], state[2], state[3] = q1, q2, v1, v2
    state[4], state[5], state[6], state[7] = last1, last2, w1, w2
    state[8], state[9] = i1, i2
    return len(reference)
