cimport cython

@cython.locals(
    k=cython.Py_ssize_t, i=cython.Py_ssize_t, n=cython.Py_ssize_t, total=double,
)
cpdef filtered(
    const double[::1] x, double[::1] y, double[::1] line, const double[::1] taps,
)

@cython.locals(
    k=cython.Py_ssize_t, i=cython.Py_ssize_t, n=cython.Py_ssize_t, last=double, x=double, y=double,
)
cpdef differentiate(
    const double[::1] g, double[::1] out, double[::1] line, const double[::1] taps, double h,
)
