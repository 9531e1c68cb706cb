cimport cython

@cython.locals(
    k=cython.Py_ssize_t, i=cython.Py_ssize_t, count=cython.Py_ssize_t, u=double, w=double,
)
cpdef filtered(
    const double[::1] x, double[::1] y, double[:, ::1] state, const double[:, ::1] sections,
)
