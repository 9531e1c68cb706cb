cimport cython

@cython.locals(
    k=cython.Py_ssize_t, i=cython.Py_ssize_t, n=cython.Py_ssize_t, whole=cython.Py_ssize_t,
    newest=cython.Py_ssize_t, s0=double, s1=double, s2=double, s3=double,
)
cpdef filtered(const double[::1] x, double[::1] y, const double[::1] taps)
