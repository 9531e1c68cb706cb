cimport cython
from scarid_cli.kernels.friction cimport Friction, System, release, sign
from scarid_cli.kernels.rigid cimport Chain

cdef extern from "math.h" nogil:
    cpdef double exp(double x)
    cpdef double sin(double x)

@cython.final
cdef class Mechanics:
    cdef Chain chain
    cdef Friction rub
    cdef System system, pairs
    cdef readonly Py_ssize_t n, size, m
    cdef public double start
    cdef public const double[:, ::1] motors, joints, couplings
    cdef const double[::1] world
    cdef public Py_ssize_t[::1] drive
    cdef public Py_ssize_t[:, ::1] ends
    cdef public double[:, ::1] motion, contact, x
    cdef public double[::1] command, lag, applied, rest
    cdef double[:, ::1] inertia, merged, columns, each
    cdef double[::1] pull, bias, held

    @cython.locals(wave=double, k=cython.Py_ssize_t, i=cython.Py_ssize_t, j=cython.Py_ssize_t)
    cpdef int evaluate(self, double t) except -1

    @cython.locals(u=double, q=double)
    cpdef double delivered(self, Py_ssize_t i, double t) except? -1.0

    @cython.locals(
        i=cython.Py_ssize_t, d=cython.Py_ssize_t, c=cython.Py_ssize_t, one=cython.Py_ssize_t,
        two=cython.Py_ssize_t, v=double, s=double, scale=double, f=double, twist=double,
        viscous=double,
    )
    cpdef int forces(self, double t) except -1

    @cython.locals(c=cython.Py_ssize_t, v=double, w=double)
    cpdef double slip(self, Py_ssize_t k) except? -1.0

    @cython.locals(i=cython.Py_ssize_t)
    cpdef int solve(self) except -1

    @cython.locals(
        i=cython.Py_ssize_t, j=cython.Py_ssize_t, c=cython.Py_ssize_t, one=cython.Py_ssize_t,
    )
    cdef int coupled(self) except -1

    cpdef double ratio(self, Py_ssize_t c) except? -1.0

    @cython.locals(j=cython.Py_ssize_t)
    cdef int merge(self, Py_ssize_t one, Py_ssize_t two, double ratio) except -1

    @cython.locals(d=cython.Py_ssize_t, j=cython.Py_ssize_t, f=double)
    cpdef double holding(self, Py_ssize_t i) except? -1.0

    @cython.locals(v=double, s=double, scale=double, f=double)
    cpdef double friction(self, Py_ssize_t i, double t) except? -1.0

    @cython.locals(i=cython.Py_ssize_t, u=double, rate=double)
    cpdef int wait(self, double h) except -1

    @cython.locals(k=cython.Py_ssize_t, scale=double, u=double)
    cdef int bounds(self, double t) except -1

    @cython.locals(k=cython.Py_ssize_t, sticks=double, v=double, still=bint)
    cpdef int touch(self, double t) except -1

    @cython.locals(k=cython.Py_ssize_t, f=double)
    cdef bint consistent(self) except -1

    @cython.locals(
        total=cython.Py_ssize_t, i=cython.Py_ssize_t, j=cython.Py_ssize_t, k=cython.Py_ssize_t,
    )
    cdef int free(self) except -1

    @cython.locals(j=cython.Py_ssize_t)
    cdef int push(self, Py_ssize_t k) except -1

    cdef bint sharp(self, Py_ssize_t k) except -1

    @cython.locals(c=cython.Py_ssize_t, v=double)
    cdef double along(self, Py_ssize_t k, double[:, ::1] x, Py_ssize_t row) except? -1.0

    @cython.locals(
        k=cython.Py_ssize_t, c=cython.Py_ssize_t, gap=double, f=double, over=bint, paired=bint,
    )
    cpdef bint events(self, double t, Py_ssize_t row) except -1
