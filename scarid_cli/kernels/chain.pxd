cimport cython

cdef extern from "math.h" nogil:
    cpdef double cos(double x)
    cpdef double sin(double x)

@cython.locals(
    i=cython.Py_ssize_t, j=cython.Py_ssize_t, k=cython.Py_ssize_t,
)
cpdef regressor(
    const double[:, ::1] axes, const double[::1] gravity, const double[:, ::1] q,
    const double[:, ::1] dq, const double[:, ::1] ddq, double[:, ::1] W, double[:, ::1] links,
)

@cython.locals(
    j=cython.Py_ssize_t, k=cython.Py_ssize_t, fx=double, fy=double, fz=double, zx=double,
    zy=double, zz=double,
)
cpdef torques(
    const double[:, ::1] axes, const double[::1] gravity, const double[:, ::1] q,
    const double[:, ::1] dq, const double[:, ::1] ddq, const double[:, ::1] bodies,
    double[:, ::1] tau, double[:, ::1] links,
)

@cython.locals(
    i=cython.Py_ssize_t, j=cython.Py_ssize_t, k=cython.Py_ssize_t,
)
cpdef gradient(
    const double[:, ::1] axes, const double[::1] gravity, const double[:, ::1] q,
    const double[:, ::1] dq, const double[:, ::1] ddq, const double[:, ::1] G, double[:, ::1] gq,
    double[:, ::1] gdq, double[:, ::1] gddq, double[:, ::1] links, double[:, ::1] back,
)

@cython.locals(
    joints=cython.Py_ssize_t, samples=cython.Py_ssize_t,
)
cdef int check(
    const double[:, ::1] axes, const double[::1] gravity, const double[:, ::1] q,
    const double[:, ::1] dq, const double[:, ::1] ddq, const double[:, ::1] links,
) except -1

cdef int sized(
    const double[:, ::1] rows, Py_ssize_t first, Py_ssize_t second,
) except -1

@cython.locals(
    i=cython.Py_ssize_t, j=cython.Py_ssize_t, p=double, zx=double, zy=double, zz=double,
)
cdef void move(
    const double[:, ::1] axes, const double[::1] gravity, const double[:, ::1] q,
    const double[:, ::1] dq, const double[:, ::1] ddq, double[:, ::1] links, Py_ssize_t k,
) noexcept nogil

cdef void rest(
    const double[::1] gravity, double[:, ::1] links,
) noexcept nogil

@cython.locals(
    i=cython.Py_ssize_t, a=double, along=double, b=double, c=double, d=double, prismatic=double,
    rest=double, s=double, x=double, y=double, z=double,
)
cdef void place(
    const double[:, ::1] axes, double[:, ::1] links, double q, Py_ssize_t j,
) noexcept nogil

@cython.locals(
    ax=double, ay=double, az=double, cx=double, cy=double, cz=double, ex=double, ey=double,
    ez=double, fx=double, fy=double, fz=double, gx=double, gy=double, gz=double, hx=double,
    hy=double, hz=double, px=double, py=double, pz=double, wx=double, wy=double, wz=double,
    zx=double, zy=double, zz=double,
)
cdef void accelerate(
    const double[:, ::1] axes, double[:, ::1] links, double dq, double ddq, Py_ssize_t j,
) noexcept nogil

@cython.locals(
    hx=double, hy=double, hz=double, px=double, py=double, pz=double, ux=double, uy=double,
    uz=double, vx=double, vy=double, vz=double,
)
cdef void carry(
    double[:, ::1] links, Py_ssize_t i, Py_ssize_t j,
) noexcept nogil

@cython.locals(
    n=cython.Py_ssize_t, ax=double, ay=double, az=double, bx=double, by=double, bz=double,
    cx=double, cy=double, cz=double, dx=double, dy=double, dz=double, ex=double, ey=double,
    ez=double, gx=double, gy=double, gz=double, hx=double, hy=double, hz=double, ux=double,
    uy=double, uz=double, vx=double, vy=double, vz=double, wx=double, wy=double, wz=double,
)
cdef void entry(
    const double[:, ::1] links, double[:, ::1] W, Py_ssize_t row, Py_ssize_t i, Py_ssize_t j,
) noexcept nogil

@cython.locals(
    ax=double, ay=double, az=double, cx=double, cy=double, cz=double, ex=double, ey=double,
    ez=double, fx=double, fy=double, fz=double, gx=double, gy=double, gz=double, hx=double,
    hy=double, hz=double, m=double, nx=double, ny=double, nz=double, px=double, py=double,
    pz=double, wx=double, wy=double, wz=double,
)
cdef void wrench(
    double[:, ::1] links, const double[:, ::1] bodies, Py_ssize_t j,
) noexcept nogil

@cython.locals(
    ax=double, ay=double, az=double, cx=double, cy=double, cz=double, ex=double, ey=double,
    ez=double, fx=double, fy=double, fz=double, hx=double, hy=double, hz=double, m=double,
    nx=double, ny=double, nz=double, ux=double, uy=double, uz=double, vx=double, vy=double,
    vz=double, wx=double, wy=double, wz=double,
)
cdef void entry_back(
    const double[:, ::1] links, double[:, ::1] back, const double[:, ::1] G, Py_ssize_t row,
    Py_ssize_t i, Py_ssize_t j,
) noexcept nogil

@cython.locals(
    i=cython.Py_ssize_t, n=cython.Py_ssize_t, ax=double, ay=double, az=double, bx=double, by=double,
    bz=double, ex=double, ey=double, ez=double, fx=double, fy=double, fz=double, hx=double,
    hy=double, hz=double, px=double, py=double, pz=double, ux=double, uy=double, uz=double,
    wx=double, wy=double, wz=double,
)
cdef void link_back(
    const double[:, ::1] links, double[:, ::1] back, Py_ssize_t j,
) noexcept nogil

@cython.locals(
    n=cython.Py_ssize_t, ax=double, ay=double, az=double, bx=double, by=double, bz=double,
    cx=double, cy=double, cz=double, prismatic=double, wx=double, wy=double, wz=double, zx=double,
    zy=double, zz=double,
)
cdef void axis_back(
    const double[:, ::1] axes, const double[:, ::1] links, double[:, ::1] back, double dq,
    double[:, ::1] gq, double[:, ::1] gdq, double[:, ::1] gddq, Py_ssize_t k, Py_ssize_t j,
) noexcept nogil

cdef (double, double, double) vector(
    const double[:, ::1] rows, Py_ssize_t j, Py_ssize_t n,
) noexcept nogil

cdef void store(
    double[:, ::1] rows, Py_ssize_t j, Py_ssize_t n, double x, double y, double z,
) noexcept nogil

cdef void push(
    double[:, ::1] rows, Py_ssize_t j, Py_ssize_t n, double x, double y, double z,
) noexcept nogil

@cython.locals(
    x=double, y=double, z=double,
)
cdef void push_cross(
    double[:, ::1] rows, Py_ssize_t j, Py_ssize_t n, double ax, double ay, double az, double bx,
    double by, double bz,
) noexcept nogil

cdef (double, double, double) cross(
    double ax, double ay, double az, double bx, double by, double bz,
) noexcept nogil

cdef (double, double, double) inwards(
    const double[:, ::1] links, Py_ssize_t j, double x, double y, double z,
) noexcept nogil

cdef (double, double, double) outwards(
    const double[:, ::1] links, Py_ssize_t j, double x, double y, double z,
) noexcept nogil

cdef (double, double, double) moment(
    const double[:, ::1] G, Py_ssize_t row, Py_ssize_t n, double x, double y, double z,
) noexcept nogil
