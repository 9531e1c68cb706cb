cimport cython

cdef extern from "math.h" nogil:
    cpdef double exp(double x)
    cpdef double sqrt(double x)
    cpdef double tanh(double x)

cpdef double sign(double x) noexcept nogil

@cython.final
cdef class Friction:
    cdef const double[:, ::1] joints

    cpdef double drift(self, Py_ssize_t i, double t) except? -1.0

    @cython.locals(
        forward=bint, jump=double, ratio=double, f=double, smooth=double, share=double, rest=double,
    )
    cpdef double own(
        self, Py_ssize_t i, double v, double s, double scale, double tau,
    ) except? -1.0

@cython.final
cdef class System:
    cdef Py_ssize_t size
    cdef const double[:, ::1] matrix
    cdef const double[::1] held
    cdef double[:, ::1] lower

    @cython.locals(i=cython.Py_ssize_t, j=cython.Py_ssize_t, k=cython.Py_ssize_t, d=double)
    cpdef int factor(self) except -1

    @cython.locals(i=cython.Py_ssize_t, k=cython.Py_ssize_t, d=double)
    cpdef int substitute(self, double[:, ::1] x, Py_ssize_t row) except -1

@cython.locals(j=cython.Py_ssize_t, a=double)
cdef int violated(
    const double[:, ::1] matrix, const double[:, ::1] contact, const double[:, ::1] x, Py_ssize_t k,
) noexcept nogil

@cython.locals(size=cython.Py_ssize_t, k=cython.Py_ssize_t, j=cython.Py_ssize_t)
cdef int stuck(
    System system, const double[:, ::1] contact, double[::1] held, double[:, ::1] x,
) except -1

@cython.locals(
    size=cython.Py_ssize_t, k=cython.Py_ssize_t, exchange=int, change=int, system=System,
    held="double[::1]", x="double[:, ::1]",
)
cpdef int release(const double[:, ::1] matrix, double[:, ::1] contact) except -1

cdef double slipping(const double[:, ::1] contact, Py_ssize_t k) noexcept nogil
