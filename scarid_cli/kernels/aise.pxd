cimport cython

@cython.locals(
    off=double, p11=double, p12=double, p22=double, eta=double, noise=double, left=double,
    least=double,
)
cdef void assimilated(
    double z, double[::1] state, double[:, ::1] gains, const double[::1] bounds, double h
) noexcept nogil

@cython.locals(
    order=cython.Py_ssize_t, i=cython.Py_ssize_t, j=cython.Py_ssize_t, c1=double, c2=double,
    total=double, effect=double,
)
cdef double regressors(
    const double[:, ::1] past, const double[:, ::1] gains, double[:, ::1] rows, double h
) noexcept nogil

@cython.locals(size=cython.Py_ssize_t, i=cython.Py_ssize_t, j=cython.Py_ssize_t, total=double)
cdef void weighed(
    const double[::1] row, double error, double variance, double[::1] theta, double[:, ::1] P,
    double[::1] work,
) noexcept nogil

@cython.locals(i=cython.Py_ssize_t, total=double)
cdef double product(const double[::1] row, const double[::1] theta) noexcept nogil

@cython.locals(i=cython.Py_ssize_t)
cdef void pushed(double[::1] row, double newest) noexcept nogil

@cython.locals(
    size=cython.Py_ssize_t, lags=cython.Py_ssize_t, k=cython.Py_ssize_t, i=cython.Py_ssize_t,
    z=double, caused=double, u=double,
)
cpdef differentiate(
    const double[::1] g, double[::1] v, double[::1] a, double[::1] state, double[::1] theta,
    double[:, ::1] P, double[:, ::1] past, double[:, ::1] gains, double[:, ::1] rows,
    const double[::1] weights, double h,
)
