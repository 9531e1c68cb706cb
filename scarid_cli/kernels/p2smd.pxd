cimport cython

cdef extern from "math.h" nogil:
    cpdef double cbrt(double x)
    cpdef double sqrt(double x)

cdef double sign(double x) noexcept nogil
cdef double clip(double x, double low, double high) noexcept nogil

@cython.locals(
    k=cython.Py_ssize_t, z0=double, z1=double, nu=double, eta0=double, eta1=double, eta2=double,
    gamma0=double, gamma1=double, keep=double, floor=double, cap=double, nu_max=double,
    e0=double, root=double, p0=double, y0=double, e1=double, s1=double, p1=double, y1=double,
)
cpdef differentiate(
    const double[::1] g, double[::1] v, double[::1] a, double[::1] state,
    const double[::1] gains, double h,
)

@cython.locals(
    k=cython.Py_ssize_t, z0=double, z1=double, nu=double, eta0=double, eta1=double, eta2=double,
    gamma0=double, gamma1=double, keep=double, floor=double, cap=double, nu_max=double,
    b=double, dead=double, e0=double, s=double, p0=double, q=double, e1=double, p1=double,
    y1=double,
)
cpdef implicit(
    const double[::1] g, double[::1] v, double[::1] a, double[::1] state,
    const double[::1] gains, double h,
)

@cython.locals(
    low=double, high=double, q=double, _=cython.Py_ssize_t, f=double, slope=double, part=double,
    value=double, rise=double, step=double, old=double,
)
cdef double root(
    double r, double eta0, double eta1, double gamma0, double gamma1, double h,
) noexcept nogil
