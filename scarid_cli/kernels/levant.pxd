cimport cython

cdef extern from "math.h" nogil:
    cpdef double pow(double x, double y)

cdef double sign(double x) noexcept nogil

@cython.locals(
    k=cython.Py_ssize_t, i=cython.Py_ssize_t, j=cython.Py_ssize_t, last=cython.Py_ssize_t,
    _=cython.Py_ssize_t, e=double, x=double, s=double, root=double, power=double, rate=double,
    step=double,
)
cpdef differentiate(
    const double[::1] g, double[::1] v, double[::1] a, double[::1] state,
    const double[::1] gains, Py_ssize_t filters, bint taylor, double h,
)

@cython.locals(j=cython.Py_ssize_t, value=double, step=double)
cdef double back(const double[::1] z, Py_ssize_t first, double h) noexcept nogil
