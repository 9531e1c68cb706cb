cimport cython

cdef extern from "math.h" nogil:
    cpdef double cos(double x)
    cpdef double floor(double x)
    cpdef double sin(double x)

cdef double sign(double x) noexcept nogil
cdef double quantised(double x, double resolution) noexcept nogil
cdef double eccentric(double q, double amplitude, double turns, double phase) noexcept nogil
cdef double clip(double x, double limit) noexcept nogil

@cython.locals(c=double, s=double, coupling=double, bend=double, m22=double)
cdef (double, double, double, double) inertia(const double[::1] model, double q2) noexcept nogil

@cython.locals(
    bend=double, m22=double, m12=double, m11=double, r1=double, r2=double, d=double,
)
cdef (double, double) accelerations(
    const double[::1] model, double q2, double v1, double v2, double tau1, double tau2,
    double s1, double s2,
) noexcept nogil

@cython.locals(bend=double, m22=double, m12=double, m11=double, f1=double, f2=double)
cdef (double, double) holding(
    const double[::1] model, double q2, double v1, double v2, double tau1, double tau2,
    double a1, double a2,
) noexcept nogil

cdef double trial(int i) noexcept nogil
cdef bint suits(double v, double s, double a, double f, double dry) noexcept nogil

@cython.locals(
    s1=double, s2=double, a1=double, a2=double, f1=double, f2=double, i=int, j=int,
)
cdef (double, double) contact(
    const double[::1] model, double q2, double v1, double v2, double tau1, double tau2,
) noexcept nogil

@cython.locals(
    k=cython.Py_ssize_t, n=cython.Py_ssize_t, d=double, smooth=double,
    q1=double, q2=double, v1=double, v2=double, last1=double, last2=double, w1=double, w2=double,
    i1=double, i2=double, m1=double, m2=double, e1=double, e2=double, tau1=double, tau2=double,
    s1=double, s2=double, a1=double, a2=double, b1=double, b2=double,
    c1=double, c2=double, d1=double, d2=double, u1=double, u2=double, x1=double, x2=double,
    y1=double, y2=double,
)
cpdef Py_ssize_t run(
    const double[:, ::1] reference, const double[:, ::1] noise, double[:, ::1] log,
    double[::1] state, const double[::1] model, const double[::1] control, double h,
    Py_ssize_t substeps,
) except -1
