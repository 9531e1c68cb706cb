cimport cython

cdef extern from "math.h" nogil:
    cpdef double cbrt(double x)
    cpdef double sqrt(double x)

cdef double sign(double x) noexcept nogil

@cython.locals(
    k=cython.Py_ssize_t, z0=double, z1=double, z2=double, eta0=double, eta1=double, eta2=double,
    e0=double, root=double, y0=double, e1=double, s1=double, y1=double,
)
cpdef differentiate(
    const double[::1] g, double[::1] v, double[::1] a, double[::1] state,
    const double[::1] gains, double h,
)
