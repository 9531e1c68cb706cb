cimport cython

cdef extern from "math.h" nogil:
    cpdef double pow(double x, double y)

@cython.locals(
    k=cython.Py_ssize_t, i=cython.Py_ssize_t, n=cython.Py_ssize_t, _=cython.Py_ssize_t,
    dead=double, b=double, s=double, q=double, power=double, rate=double,
)
cpdef differentiate(
    const double[::1] g, double[::1] v, double[::1] a, double[::1] state,
    const double[::1] gains, double h,
)

@cython.locals(
    i=cython.Py_ssize_t, _=cython.Py_ssize_t, q=double, value=double, slope=double, scale=double,
    step=double,
)
cdef double root(double r, const double[::1] gains, Py_ssize_t n, double h) noexcept nogil

@cython.locals(i=cython.Py_ssize_t, value=double, step=double)
cdef double velocity(const double[::1] z, Py_ssize_t n, double h) noexcept nogil

cdef double acceleration(const double[::1] z, Py_ssize_t n, double h) noexcept nogil
