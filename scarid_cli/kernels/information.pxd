cimport cython

cdef extern from "math.h" nogil:
    cpdef double sqrt(double x)

cdef double LEAST

@cython.locals(
    p=cython.Py_ssize_t, samples=cython.Py_ssize_t, joints=cython.Py_ssize_t,
    k=cython.Py_ssize_t, n=cython.Py_ssize_t, j=cython.Py_ssize_t,
    traced=cython.bint, forgets=cython.bint, weighs=cython.bint,
)
cpdef update(
    const double[:, :, ::1] W, const double[:, ::1] y, const double[:, ::1] scales,
    double[:, ::1] triangle, double[::1] row, double[::1] sums, double[:, ::1] estimates,
    const double[::1] forgetting, double floor, double[:, ::1] residuals,
    double apart,
)

@cython.locals(p=cython.Py_ssize_t, n=cython.Py_ssize_t)
cdef check(
    const double[:, :, ::1] W, const double[:, ::1] y, const double[:, ::1] scales,
    double[:, ::1] triangle, double[::1] row, double[::1] sums, double[:, ::1] estimates,
    const double[::1] forgetting, double[:, ::1] residuals,
)

@cython.locals(
    j=cython.Py_ssize_t, scale=double, weight=double, square=double, tau=double,
    weighs=cython.bint,
)
cdef void take(
    const double[:, :, ::1] W, const double[:, ::1] y, const double[:, ::1] scales,
    double[:, ::1] triangle, double[::1] row, double[::1] sums, double[:, ::1] residuals,
    double forgetting, Py_ssize_t k, Py_ssize_t n, Py_ssize_t p,
) noexcept nogil

@cython.locals(n=cython.Py_ssize_t, largest=double, least=double, own=double)
cdef void weigh(double[:, ::1] residuals, Py_ssize_t joints, double needed, double apart) noexcept nogil

@cython.locals(rows=double, share=double)
cdef double variance(double[:, ::1] residuals, Py_ssize_t n, double needed, double apart) noexcept nogil

@cython.locals(i=cython.Py_ssize_t, count=cython.Py_ssize_t)
cdef bint differs(const double[::1] factors, double value, Py_ssize_t p) noexcept nogil

@cython.locals(i=cython.Py_ssize_t, theta=double, back=double, several=cython.bint)
cdef void forget(
    double[:, ::1] triangle, double[::1] row, const double[::1] forgetting, double floor,
    Py_ssize_t turn, Py_ssize_t p,
) noexcept nogil

@cython.locals(j=cython.Py_ssize_t, z=double, ratio=double)
cdef void tilt(
    double[:, ::1] triangle, double[::1] theta, const double[::1] forgetting, Py_ssize_t i,
    Py_ssize_t p,
) noexcept nogil

@cython.locals(
    i=cython.Py_ssize_t, j=cython.Py_ssize_t, x=double, d=double, pull=double, total=double,
    c=double, s=double, t=double, u=double,
)
cdef double rotate(
    double[:, ::1] triangle, double[::1] row, double weight, Py_ssize_t p,
) noexcept nogil

@cython.locals(i=cython.Py_ssize_t, j=cython.Py_ssize_t, x=double)
cdef void solve(double[:, ::1] triangle, double[::1] row, Py_ssize_t p) noexcept nogil
