cimport cython

cdef extern from "math.h" nogil:
    cpdef double sqrt(double x)

cdef double sign(double x) noexcept nogil

@cython.locals(
    k=cython.Py_ssize_t, z0=double, z1=double, k0=double, epsilon=double, growth=double,
    alpha0=double, gamma=double, k0m=double, e=double, s=double, y0=double,
)
cpdef differentiate(
    const double[::1] g, double[::1] out, double[::1] state, const double[::1] gains, double h,
)
