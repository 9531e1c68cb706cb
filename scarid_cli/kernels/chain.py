"""The regressor of the standard parameters of a serial chain, and its reverse pass.

Newton-Euler recursion in the frames of the links (Atkeson, An and Hollerbach 1986). The torque of
axis i that link j causes is u.n + v.f: f and n are the force and the moment on the link, linear in
its ten parameters; u and v are the angular velocity and the velocity of the link's origin that a
unit velocity of axis i causes. The reverse pass differentiates the recursion backwards.

The functions share work space, `links` (joints + 1, 21 + 6 joints). Row 0 is the base and row
j + 1 link j: [0:9] the rotation from the frame of the link to that of the link before it, row by
row; [9:12] the origin of the link there; then, in the frame of the link, [12:15] its angular
velocity, [15:18] its angular acceleration, [18:21] the acceleration of its origin less gravity,
and from 21 + 6 i on u and v of axis i.
"""

from math import cos, sin


def regressor(axes, gravity, q, dq, ddq, W, links):
    """Write the regressor to W (samples joints, 10 joints), a row for each joint of each sample.

    Columns 10 j to 10 j + 9 are the torques per unit of Ixx, Ixy, Ixz, Iyy, Iyz, Izz (about the
    origin of the axis), mx, my, mz and m of link j. axes (joints, 16) and gravity (3): see
    mechanism.Mechanism. q, dq, ddq (joints, samples). Each sample is computed by itself.
    """
    check(axes, gravity, q, dq, ddq, links)
    sized(W, q.shape[1] * q.shape[0], 10 * q.shape[0])
    for k in range(q.shape[1]):
        move(axes, gravity, q, dq, ddq, links, k)
        for j in range(1, q.shape[0] + 1):
            for i in range(q.shape[0]):
                entry(links, W, k * q.shape[0] + i, i, j)


def torques(axes, gravity, q, dq, ddq, bodies, tau, links):
    """Write the torques of the axes (joints, samples) to tau, by the forces from the tip inwards.

    bodies (joints, 10) are the parameters in the order of the regressor's columns. Row j of `links`
    keeps, behind the motion of the link, [21:27] the force and the moment that axis j carries.
    """
    check(axes, gravity, q, dq, ddq, links)
    sized(bodies, q.shape[0], 10)
    sized(tau, q.shape[0], q.shape[1])
    for k in range(q.shape[1]):
        rest(gravity, links)
        for j in range(1, links.shape[0]):
            place(axes, links, float(q[j - 1, k]), j)
            accelerate(axes, links, float(dq[j - 1, k]), float(ddq[j - 1, k]), j)
        for j in range(q.shape[0], 0, -1):
            wrench(links, bodies, j)
            zx, zy, zz = vector(axes, j - 1, 12)
            fx, fy, fz = vector(links, j, 21 if float(axes[j - 1, 15]) != 0.0 else 24)
            tau[j - 1, k] = zx * fx + zy * fy + zz * fz


def gradient(axes, gravity, q, dq, ddq, G, gq, gdq, gddq, links, back):
    """Write the derivatives of sum(G W) with respect to q, dq and ddq to gq, gdq and gddq.

    G has the shape of W; gq, gdq and gddq (joints, samples) that of q. `back` has the derivatives
    with respect to what stands at the same place of `links`; at [0:3] to a rotation of the link.
    """
    check(axes, gravity, q, dq, ddq, links)
    check(axes, gravity, gq, gdq, gddq, back)
    sized(G, q.shape[1] * q.shape[0], 10 * q.shape[0])
    for k in range(q.shape[1]):
        move(axes, gravity, q, dq, ddq, links, k)
        back[:, :] = 0.0
        for j in range(q.shape[0], 0, -1):
            for i in range(j):
                entry_back(links, back, G, k * q.shape[0] + i, i, j)
            link_back(links, back, j)
            axis_back(axes, links, back, float(dq[j - 1, k]), gq, gdq, gddq, k, j)


def check(axes, gravity, q, dq, ddq, links):
    """Refuse arrays whose sizes do not belong together."""
    joints = axes.shape[0]
    samples = q.shape[1]
    if axes.shape[1] != 16 or len(gravity) != 3:
        raise ValueError("chain: sizes of axes or gravity are wrong")
    if q.shape[0] != joints or dq.shape[0] != joints or ddq.shape[0] != joints:
        raise ValueError("chain: numbers of joints differ")
    if dq.shape[1] != samples or ddq.shape[1] != samples:
        raise ValueError("chain: numbers of samples differ")
    if links.shape[0] != joints + 1:
        raise ValueError("chain: numbers of links differ")
    if links.shape[1] != 21 + 6 * joints:
        raise ValueError("chain: sizes of the work space are wrong")


def sized(rows, first, second):
    """Refuse rows of another size."""
    if rows.shape[0] != first or rows.shape[1] != second:
        raise ValueError("chain: sizes of the rows are wrong")


def move(axes, gravity, q, dq, ddq, links, k):
    """The motion of all links at sample k."""
    rest(gravity, links)
    for j in range(1, links.shape[0]):
        place(axes, links, float(q[j - 1, k]), j)
        accelerate(axes, links, float(dq[j - 1, k]), float(ddq[j - 1, k]), j)
        for i in range(j - 1):
            carry(links, i, j)
        zx, zy, zz = vector(axes, j - 1, 12)
        p = float(axes[j - 1, 15])
        store(links, j, 15 + 6 * j, (1.0 - p) * zx, (1.0 - p) * zy, (1.0 - p) * zz)
        store(links, j, 18 + 6 * j, p * zx, p * zy, p * zz)


def rest(gravity, links):
    """The motion of the base."""
    store(links, 0, 12, 0.0, 0.0, 0.0)
    store(links, 0, 15, 0.0, 0.0, 0.0)
    store(links, 0, 18, -float(gravity[0]), -float(gravity[1]), -float(gravity[2]))


def place(axes, links, q, j):
    """The rotation (Rodrigues) and the origin of link j, its axis at the position q."""
    x, y, z = vector(axes, j - 1, 12)
    prismatic = float(axes[j - 1, 15])
    c = cos(q) if prismatic == 0.0 else 1.0
    s = sin(q) if prismatic == 0.0 else 0.0
    for i in range(3):
        a, b, d = vector(axes, j - 1, 3 * i)
        along = a * x + b * y + d * z
        rest = (1.0 - c) * along
        links[j, 3 * i] = c * a + s * (b * z - d * y) + rest * x
        links[j, 3 * i + 1] = c * b + s * (d * x - a * z) + rest * y
        links[j, 3 * i + 2] = c * d + s * (a * y - b * x) + rest * z
        links[j, 9 + i] = float(axes[j - 1, 9 + i]) + prismatic * q * along


def accelerate(axes, links, dq, ddq, j):
    """The velocity and acceleration of link j, from those of the link before it."""
    wx, wy, wz = vector(links, j - 1, 12)
    ex, ey, ez = vector(links, j - 1, 15)
    ax, ay, az = vector(links, j - 1, 18)
    px, py, pz = vector(links, j, 9)
    zx, zy, zz = vector(axes, j - 1, 12)
    hx, hy, hz = cross(wx, wy, wz, px, py, pz)
    fx, fy, fz = cross(wx, wy, wz, hx, hy, hz)
    gx, gy, gz = cross(ex, ey, ez, px, py, pz)
    wx, wy, wz = inwards(links, j, wx, wy, wz)
    ex, ey, ez = inwards(links, j, ex, ey, ez)
    ax, ay, az = inwards(links, j, ax + fx + gx, ay + fy + gy, az + fz + gz)
    cx, cy, cz = cross(wx, wy, wz, dq * zx, dq * zy, dq * zz)
    if float(axes[j - 1, 15]) == 0.0:
        wx, wy, wz = wx + dq * zx, wy + dq * zy, wz + dq * zz
        ex, ey, ez = ex + cx + ddq * zx, ey + cy + ddq * zy, ez + cz + ddq * zz
    else:
        ax += 2.0 * cx + ddq * zx
        ay += 2.0 * cy + ddq * zy
        az += 2.0 * cz + ddq * zz
    store(links, j, 12, wx, wy, wz)
    store(links, j, 15, ex, ey, ez)
    store(links, j, 18, ax, ay, az)


def carry(links, i, j):
    """The velocities of link j that axis i causes, from those of the link before it."""
    ux, uy, uz = vector(links, j - 1, 21 + 6 * i)
    vx, vy, vz = vector(links, j - 1, 24 + 6 * i)
    px, py, pz = vector(links, j, 9)
    hx, hy, hz = cross(ux, uy, uz, px, py, pz)
    ux, uy, uz = inwards(links, j, ux, uy, uz)
    vx, vy, vz = inwards(links, j, vx + hx, vy + hy, vz + hz)
    store(links, j, 21 + 6 * i, ux, uy, uz)
    store(links, j, 24 + 6 * i, vx, vy, vz)


def entry(links, W, row, i, j):
    """The torque of axis i per unit of the parameters of the link in row j."""
    if i >= j:
        for n in range(10):
            W[row, 10 * j - 10 + n] = 0.0
        return
    wx, wy, wz = vector(links, j, 12)
    ex, ey, ez = vector(links, j, 15)
    ax, ay, az = vector(links, j, 18)
    ux, uy, uz = vector(links, j, 21 + 6 * i)
    vx, vy, vz = vector(links, j, 24 + 6 * i)
    gx, gy, gz = cross(ux, uy, uz, wx, wy, wz)
    W[row, 10 * j - 10] = ux * ex + gx * wx
    W[row, 10 * j - 9] = ux * ey + uy * ex + gx * wy + gy * wx
    W[row, 10 * j - 8] = ux * ez + uz * ex + gx * wz + gz * wx
    W[row, 10 * j - 7] = uy * ey + gy * wy
    W[row, 10 * j - 6] = uy * ez + uz * ey + gy * wz + gz * wy
    W[row, 10 * j - 5] = uz * ez + gz * wz
    hx, hy, hz = cross(vx, vy, vz, wx, wy, wz)
    cx, cy, cz = cross(hx, hy, hz, wx, wy, wz)
    dx, dy, dz = cross(vx, vy, vz, ex, ey, ez)
    bx, by, bz = cross(ax, ay, az, ux, uy, uz)
    store(W, row, 10 * j - 4, bx + cx + dx, by + cy + dy, bz + cz + dz)
    W[row, 10 * j - 1] = vx * ax + vy * ay + vz * az


def wrench(links, bodies, j):
    """The force on the link in row j and what it carries, and their moment about its origin."""
    wx, wy, wz = vector(links, j, 12)
    ex, ey, ez = vector(links, j, 15)
    ax, ay, az = vector(links, j, 18)
    cx, cy, cz = vector(bodies, j - 1, 6)
    m = float(bodies[j - 1, 9])
    hx, hy, hz = cross(wx, wy, wz, cx, cy, cz)
    gx, gy, gz = cross(wx, wy, wz, hx, hy, hz)
    hx, hy, hz = cross(ex, ey, ez, cx, cy, cz)
    fx, fy, fz = m * ax + gx + hx, m * ay + gy + hy, m * az + gz + hz
    hx, hy, hz = moment(bodies, j - 1, 0, wx, wy, wz)
    gx, gy, gz = cross(wx, wy, wz, hx, hy, hz)
    hx, hy, hz = moment(bodies, j - 1, 0, ex, ey, ez)
    nx, ny, nz = cross(cx, cy, cz, ax, ay, az)
    nx, ny, nz = nx + gx + hx, ny + gy + hy, nz + gz + hz
    if j + 1 < links.shape[0]:
        ax, ay, az = vector(links, j + 1, 21)
        ax, ay, az = outwards(links, j + 1, ax, ay, az)
        px, py, pz = vector(links, j + 1, 9)
        gx, gy, gz = cross(px, py, pz, ax, ay, az)
        hx, hy, hz = vector(links, j + 1, 24)
        hx, hy, hz = outwards(links, j + 1, hx, hy, hz)
        fx, fy, fz = fx + ax, fy + ay, fz + az
        nx, ny, nz = nx + gx + hx, ny + gy + hy, nz + gz + hz
    store(links, j, 21, fx, fy, fz)
    store(links, j, 24, nx, ny, nz)


def entry_back(links, back, G, row, i, j):
    """Add the derivatives of the torque of axis i that link j causes with G as its parameters."""
    wx, wy, wz = vector(links, j, 12)
    ex, ey, ez = vector(links, j, 15)
    ax, ay, az = vector(links, j, 18)
    ux, uy, uz = vector(links, j, 21 + 6 * i)
    vx, vy, vz = vector(links, j, 24 + 6 * i)
    cx, cy, cz = vector(G, row, 10 * j - 4)
    m = float(G[row, 10 * j - 1])
    nx, ny, nz = moment(G, row, 10 * j - 10, wx, wy, wz)
    hx, hy, hz = cross(wx, wy, wz, cx, cy, cz)
    push_cross(back, j, 24 + 6 * i, wx, wy, wz, hx, hy, hz)
    push_cross(back, j, 24 + 6 * i, ex, ey, ez, cx, cy, cz)
    push(back, j, 24 + 6 * i, m * ax, m * ay, m * az)
    push_cross(back, j, 21 + 6 * i, wx, wy, wz, nx, ny, nz)
    push_cross(back, j, 21 + 6 * i, cx, cy, cz, ax, ay, az)
    fx, fy, fz = moment(G, row, 10 * j - 10, ex, ey, ez)
    push(back, j, 21 + 6 * i, fx, fy, fz)
    push_cross(back, j, 18, ux, uy, uz, cx, cy, cz)
    push(back, j, 18, m * vx, m * vy, m * vz)
    push_cross(back, j, 15, cx, cy, cz, vx, vy, vz)
    fx, fy, fz = moment(G, row, 10 * j - 10, ux, uy, uz)
    push(back, j, 15, fx, fy, fz)
    push_cross(back, j, 12, nx, ny, nz, ux, uy, uz)
    push_cross(back, j, 12, hx, hy, hz, vx, vy, vz)
    fx, fy, fz = cross(vx, vy, vz, wx, wy, wz)
    push_cross(back, j, 12, cx, cy, cz, fx, fy, fz)
    fx, fy, fz = cross(ux, uy, uz, wx, wy, wz)
    fx, fy, fz = moment(G, row, 10 * j - 10, fx, fy, fz)
    push(back, j, 12, fx, fy, fz)


def link_back(links, back, j):
    """Take the derivatives from link j to the link before it, and to its rotation and origin."""
    for n in range(12, 15 + 6 * j, 3):
        bx, by, bz = vector(back, j, n)
        ux, uy, uz = vector(links, j, n)
        push_cross(back, j, 0, bx, by, bz, ux, uy, uz)
        bx, by, bz = outwards(links, j, bx, by, bz)
        push(back, j - 1, n, bx, by, bz)
    px, py, pz = vector(links, j, 9)
    for i in range(j - 1):
        ux, uy, uz = vector(links, j - 1, 21 + 6 * i)
        bx, by, bz = vector(back, j, 24 + 6 * i)
        bx, by, bz = outwards(links, j, bx, by, bz)
        push_cross(back, j - 1, 21 + 6 * i, px, py, pz, bx, by, bz)
        push_cross(back, j, 9, bx, by, bz, ux, uy, uz)
    wx, wy, wz = vector(links, j - 1, 12)
    ex, ey, ez = vector(links, j - 1, 15)
    ax, ay, az = vector(back, j, 18)
    ax, ay, az = outwards(links, j, ax, ay, az)
    hx, hy, hz = cross(wx, wy, wz, px, py, pz)
    fx, fy, fz = cross(ax, ay, az, wx, wy, wz)
    push_cross(back, j - 1, 12, hx, hy, hz, ax, ay, az)
    push_cross(back, j - 1, 12, px, py, pz, fx, fy, fz)
    push_cross(back, j - 1, 15, px, py, pz, ax, ay, az)
    push_cross(back, j, 9, fx, fy, fz, wx, wy, wz)
    push_cross(back, j, 9, ax, ay, az, ex, ey, ez)


def axis_back(axes, links, back, dq, gq, gdq, gddq, k, j):
    """The derivatives with respect to the motion of the axis of link j."""
    zx, zy, zz = vector(axes, j - 1, 12)
    prismatic = float(axes[j - 1, 15])
    n = 18 if prismatic != 0.0 else 15
    ax, ay, az = vector(back, j, n)
    gddq[j - 1, k] = ax * zx + ay * zy + az * zz
    dq *= 1.0 + prismatic
    cx, cy, cz = cross(zx, zy, zz, dq * ax, dq * ay, dq * az)
    cx, cy, cz = outwards(links, j, cx, cy, cz)
    push(back, j - 1, 12, cx, cy, cz)
    wx, wy, wz = vector(links, j, 12)
    cx, cy, cz = cross(ax, ay, az, wx, wy, wz)
    gdq[j - 1, k] = (1.0 + prismatic) * (cx * zx + cy * zy + cz * zz)
    if prismatic != 0.0:
        zx, zy, zz = outwards(links, j, zx, zy, zz)
        bx, by, bz = vector(back, j, 9)
    else:
        bx, by, bz = vector(back, j, 12)
        gdq[j - 1, k] = float(gdq[j - 1, k]) + bx * zx + by * zy + bz * zz
        bx, by, bz = vector(back, j, 0)
    gq[j - 1, k] = bx * zx + by * zy + bz * zz


def vector(rows, j, n):
    """The vector in row j, from place n on."""
    return float(rows[j, n]), float(rows[j, n + 1]), float(rows[j, n + 2])


def store(rows, j, n, x, y, z):
    """Write a vector to row j, from place n on."""
    rows[j, n], rows[j, n + 1], rows[j, n + 2] = x, y, z


def push(rows, j, n, x, y, z):
    """Add a vector to that in row j."""
    rows[j, n] = float(rows[j, n]) + x
    rows[j, n + 1] = float(rows[j, n + 1]) + y
    rows[j, n + 2] = float(rows[j, n + 2]) + z


def push_cross(rows, j, n, ax, ay, az, bx, by, bz):
    """Add a vector product to the vector in row j."""
    x, y, z = cross(ax, ay, az, bx, by, bz)
    push(rows, j, n, x, y, z)


def cross(ax, ay, az, bx, by, bz):
    """The vector product a x b."""
    return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx


def inwards(links, j, x, y, z):
    """A vector of the frame before that of row j, in the frame of row j."""
    return (
        float(links[j, 0]) * x + float(links[j, 3]) * y + float(links[j, 6]) * z,
        float(links[j, 1]) * x + float(links[j, 4]) * y + float(links[j, 7]) * z,
        float(links[j, 2]) * x + float(links[j, 5]) * y + float(links[j, 8]) * z,
    )


def outwards(links, j, x, y, z):
    """A vector of the frame of row j, in the frame before it."""
    return (
        float(links[j, 0]) * x + float(links[j, 1]) * y + float(links[j, 2]) * z,
        float(links[j, 3]) * x + float(links[j, 4]) * y + float(links[j, 5]) * z,
        float(links[j, 6]) * x + float(links[j, 7]) * y + float(links[j, 8]) * z,
    )


def moment(G, row, n, x, y, z):
    """The inertia matrix of the six moments and products in G, times a vector."""
    return (
        float(G[row, n]) * x + float(G[row, n + 1]) * y + float(G[row, n + 2]) * z,
        float(G[row, n + 1]) * x + float(G[row, n + 3]) * y + float(G[row, n + 4]) * z,
        float(G[row, n + 2]) * x + float(G[row, n + 4]) * y + float(G[row, n + 5]) * z,
    )
