cimport cython

@cython.locals(
    k=cython.Py_ssize_t, i=cython.Py_ssize_t, n=cython.Py_ssize_t, whole=cython.Py_ssize_t,
    rows=cython.Py_ssize_t, first=cython.Py_ssize_t, a=double, b=double, c=double, d=double,
    newer=double, older=double,
)
cpdef filtered(const double[::1] x, double[::1] y, const double[::1] taps)
