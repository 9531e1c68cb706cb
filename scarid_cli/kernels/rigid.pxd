cimport cython

cdef extern from "math.h" nogil:
    cpdef double cos(double x)
    cpdef double sin(double x)

@cython.final
cdef class Chain:
    cdef Py_ssize_t n, axes
    cdef Py_ssize_t[::1] axis
    cdef const double[:, ::1] body
    cdef const double[:, ::1] motion
    cdef double[:, ::1] link, inertia
    cdef const double[::1] pull
    cdef double[::1] bias

    @cython.locals(i=cython.Py_ssize_t, k=cython.Py_ssize_t, torque=double)
    cpdef int compute(self) except -1

    @cython.locals(
        q=double, c=double, s=double, x=double, y=double, k=cython.Py_ssize_t,
    )
    cdef int place(self, Py_ssize_t i) except -1

    cdef (double, double, double) row(self, Py_ssize_t i, Py_ssize_t k) noexcept

    cdef (double, double, double) turned(self, Py_ssize_t i, double x, double y, double z) noexcept

    cdef (double, double, double) back(self, Py_ssize_t i, double x, double y, double z) noexcept

    @cython.locals(
        v=double, px=double, py=double, pz=double, wx=double, wy=double, wz=double,
        bx=double, by=double, bz=double, ax=double, ay=double, az=double,
        ux=double, uy=double, uz=double,
    )
    cdef int outward(self, Py_ssize_t i) except -1

    @cython.locals(
        k=cython.Py_ssize_t, wx=double, wy=double, wz=double, bx=double, by=double, bz=double,
        ax=double, ay=double, az=double, xx=double, xy=double, xz=double, yy=double, yz=double,
        zz=double, cx=double, cy=double, cz=double, m=double, ux=double, uy=double, uz=double,
        hx=double, hy=double, hz=double,
    )
    cdef int load(self, Py_ssize_t i) except -1

    @cython.locals(
        px=double, py=double, pz=double, x=double, y=double, z=double, mx=double, my=double, mz=double,
    )
    cdef int inward(self, Py_ssize_t i) except -1

    @cython.locals(
        px=double, py=double, pz=double, m=double, cx=double, cy=double, cz=double,
        ux=double, uy=double, uz=double, vx=double, vy=double, vz=double,
        wx=double, wy=double, wz=double, xx=double, xy=double, xz=double, yy=double, yz=double,
        zz=double, sx=double, sy=double, sz=double, _=double,
    )
    cdef int combine(self, Py_ssize_t i) except -1

    @cython.locals(
        k=cython.Py_ssize_t, px=double, py=double, pz=double, x=double, y=double, z=double,
        mx=double, my=double, mz=double,
    )
    cdef int column(self, Py_ssize_t i) except -1

    cdef int add(self, Py_ssize_t i, Py_ssize_t k, double entry) except -1

cpdef int dynamics(
    const double[:, ::1] body, const double[::1] pull, const double[:, ::1] motion,
    double[::1] bias, double[:, ::1] inertia,
) except -1
