cimport cython
from scarid_cli.kernels.friction cimport Friction, sign
from scarid_cli.kernels.rigid cimport Chain

cdef extern from "math.h" nogil:
    cpdef double floor(double x)
    cpdef double sin(double x)

cpdef double eccentric(double q, double amplitude, double turns, double phase) noexcept nogil
cpdef double quantised(double x, double resolution) noexcept nogil

@cython.final
cdef class Controller:
    cdef Chain chain
    cdef Friction rub
    cdef Py_ssize_t n
    cdef const double[:, ::1] gains, motors, joints, couplings
    cdef const double[::1] setup
    cdef double[:, ::1] memory, motion, inertia
    cdef double[::1] wanted, bias

    @cython.locals(
        n=cython.Py_ssize_t, i=cython.Py_ssize_t, h=double, smooth=double, w=double, e=double,
        rate=double,
    )
    cpdef int command(
        self, const double[:, ::1] reference, Py_ssize_t k, const double[::1] reading,
        double[::1] tau,
    ) except -1

    @cython.locals(
        n=cython.Py_ssize_t, i=cython.Py_ssize_t, j=cython.Py_ssize_t, computed=bint, m=double,
        v=double,
    )
    cdef int model(
        self, const double[:, ::1] reference, Py_ssize_t k, double[::1] tau,
    ) except -1

    @cython.locals(
        n=cython.Py_ssize_t, c=cython.Py_ssize_t, one=cython.Py_ssize_t, two=cython.Py_ssize_t,
        v=double, w=double, slip=double, f=double,
    )
    cdef int coupled(
        self, const double[:, ::1] reference, Py_ssize_t k, double[::1] tau,
    ) except -1
