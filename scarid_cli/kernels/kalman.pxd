cimport cython

cdef extern from "math.h" nogil:
    cpdef double log(double x)

cdef double SETTLED
cdef double PATIENCE
cdef double MEMORY

@cython.locals(k=cython.Py_ssize_t, i=cython.Py_ssize_t, m=cython.Py_ssize_t)
cpdef filtered(
    const double[::1] g, double[:, ::1] estimates, double[::1] x, double[:, ::1] P,
    double[::1] gain, double[::1] work, const double[:, ::1] F, const double[:, ::1] Q,
    const double[::1] noise,
)

@cython.locals(
    k=cython.Py_ssize_t, i=cython.Py_ssize_t, j=cython.Py_ssize_t, m=cython.Py_ssize_t,
    n=cython.Py_ssize_t, settled=double, u=double,
)
cpdef recorded(
    const double[::1] g, double[:, ::1] predictions, double[::1] innovations,
    double[::1] steady, double[:, ::1] gains, double[:, :, ::1] covariances, double[::1] x, double[:, ::1] P,
    double[::1] gain, double[::1] work, const double[:, ::1] F, const double[:, ::1] Q,
    const double[::1] noise,
)

@cython.locals(i=cython.Py_ssize_t, j=cython.Py_ssize_t)
cdef void keep(
    double[:, :, ::1] covariances, double[:, ::1] P, Py_ssize_t k, Py_ssize_t m,
) noexcept nogil

cdef check(
    Py_ssize_t m, const double[:, ::1] P, const double[::1] gain, const double[::1] work, const double[:, ::1] F,
    const double[:, ::1] Q, const double[::1] noise,
)

cdef check_records(
    Py_ssize_t n, Py_ssize_t m, const double[:, ::1] predictions,
    const double[::1] innovations, const double[::1] steady,
    const double[:, ::1] gains, const double[:, :, ::1] covariances,
)

@cython.locals(i=cython.Py_ssize_t, j=cython.Py_ssize_t, e=double, s=double)
cdef bint update(
    double g, double[::1] x, double[:, ::1] P, double[::1] gain, double[::1] work, double r,
    double gate, Py_ssize_t m,
) noexcept nogil

@cython.locals(i=cython.Py_ssize_t, still=double, old=double)
cdef double settle(
    double[:, ::1] P, double[::1] gain, double s, Py_ssize_t m,
) noexcept nogil

@cython.locals(usual=double)
cdef bint glitch(double e, double s, double[::1] work, double gate) noexcept nogil

@cython.locals(i=cython.Py_ssize_t, j=cython.Py_ssize_t, total=double)
cdef void predict(
    double[::1] x, double[:, ::1] P, double[::1] work, const double[:, ::1] F,
    const double[:, ::1] Q, Py_ssize_t m,
) noexcept nogil

@cython.locals(
    i=cython.Py_ssize_t, j=cython.Py_ssize_t, n=cython.Py_ssize_t, room=cython.Py_ssize_t,
    total=double,
)
cdef void spread(
    double[:, ::1] P, double[::1] work, const double[:, ::1] F, const double[:, ::1] Q,
    Py_ssize_t m,
) noexcept nogil

@cython.locals(
    n=cython.Py_ssize_t, m=cython.Py_ssize_t, d=cython.Py_ssize_t, unsettled=cython.Py_ssize_t,
    seen=cython.Py_ssize_t, k=cython.Py_ssize_t, i=cython.Py_ssize_t, j=cython.Py_ssize_t,
)
cpdef lagged(
    const double[:, ::1] predictions, const double[::1] innovations, const double[::1] steady,
    const double[:, ::1] gains, const double[:, :, ::1] covariances,
    const double[:, ::1] P, const double[:, ::1] F,
    const double[:, ::1] weights, double[:, ::1] out, double[::1] r,
)

@cython.locals(
    n=cython.Py_ssize_t, whole=cython.Py_ssize_t, j=cython.Py_ssize_t, s0=double, s1=double,
    s2=double, s3=double,
)
cdef double weighed(
    const double[:, ::1] weights, const double[::1] innovations, Py_ssize_t row, Py_ssize_t k,
    Py_ssize_t d,
) noexcept nogil

@cython.locals(
    n=cython.Py_ssize_t, m=cython.Py_ssize_t, k=cython.Py_ssize_t, i=cython.Py_ssize_t,
)
cpdef smoothed(
    const double[:, ::1] predictions, const double[::1] innovations, const double[::1] steady,
    const double[:, ::1] gains, const double[:, :, ::1] covariances,
    const double[:, ::1] P, const double[:, ::1] F,
    double[:, ::1] out, double[::1] r,
)

@cython.locals(i=cython.Py_ssize_t, j=cython.Py_ssize_t, along=double, total=double)
cdef void back(
    const double[::1] innovations, const double[:, ::1] gains, const double[:, ::1] F,
    double[::1] r, Py_ssize_t k, Py_ssize_t m,
) noexcept nogil

@cython.locals(j=cython.Py_ssize_t, total=double)
cdef double corrected(
    const double[:, ::1] predictions, const double[:, :, ::1] covariances,
    const double[::1] steady, const double[:, ::1] P, const double[::1] r,
    Py_ssize_t k, Py_ssize_t i, Py_ssize_t m,
) noexcept nogil
