cimport cython

@cython.locals(
    k=cython.Py_ssize_t, count=double, mean=double, about=double, errors=double, squares=double,
    x=double, error=double, delta=double,
)
cpdef accumulate(const double[::1] measured, const double[::1] predicted, double[::1] state)
