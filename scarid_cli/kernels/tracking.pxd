cimport cython

cdef extern from "math.h" nogil:
    cpdef double sqrt(double x)

@cython.locals(d=double, a0=double, y=double, root=double, a=double)
cdef double fhan(double e, double v, double r, double h0) noexcept nogil

@cython.locals(
    k=cython.Py_ssize_t, x1=double, x2=double, r=double, h0=double, u=double,
)
cpdef follow(
    const double[::1] g, double[::1] x, double[::1] v, double[::1] state,
    const double[::1] gains, double h,
)
