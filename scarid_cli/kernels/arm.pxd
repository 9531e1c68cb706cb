cimport cython
from scarid_cli.kernels.control cimport Controller, eccentric, quantised
from scarid_cli.kernels.mechanics cimport Mechanics

@cython.final
cdef class Arm:
    cdef Mechanics mechanics
    cdef double[:, ::1] state, k

    @cython.locals(m=Mechanics, i=cython.Py_ssize_t)
    cdef int begin(self, double t) except -1

    @cython.locals(m=Mechanics, i=cython.Py_ssize_t)
    cdef int stage(self, double t, Py_ssize_t row) except -1

    @cython.locals(
        m=Mechanics, i=cython.Py_ssize_t, q=double, v=double, a=double, b=double,
    )
    cdef int step(self, double t, double d) except -1

    @cython.locals(
        m=Mechanics, low=double, high=double, side=double, trial=int, share=double, gap=double,
        middle=double, over=bint, k=cython.Py_ssize_t,
    )
    cdef double locate(self, double t, double d) except? -2.0

    @cython.locals(
        m=Mechanics, done=double, attempt=cython.Py_ssize_t, part=double, i=cython.Py_ssize_t,
    )
    cdef int advance(self, double t, double d) except -1

    @cython.locals(
        m=Mechanics, i=cython.Py_ssize_t, k=cython.Py_ssize_t, c=cython.Py_ssize_t, v=double,
    )
    cdef int accept(self) except -1

    @cython.locals(m=Mechanics, k=cython.Py_ssize_t, v=double)
    cdef int stop(self) except -1

    @cython.locals(m=Mechanics, i=cython.Py_ssize_t, d=cython.Py_ssize_t)
    cdef int write(self, double[:, ::1] log, Py_ssize_t k, const double[::1] reading) except -1

    @cython.locals(i=cython.Py_ssize_t)
    cdef bint lost(self) except -1

@cython.locals(
    mechanics=Mechanics, controller=Controller, arm=Arm, n=cython.Py_ssize_t,
    size=cython.Py_ssize_t, h=double, d=double, k=cython.Py_ssize_t, i=cython.Py_ssize_t,
    j=cython.Py_ssize_t, place=cython.Py_ssize_t, q=double, reading="double[::1]",
)
cpdef Py_ssize_t run(
    const double[:, ::1] reference, const double[:, ::1] noise, double[:, ::1] log,
    double[:, ::1] state, double[::1] lag, double[:, ::1] memory, tuple plant, tuple model,
    const double[:, ::1] gains, double[::1] setup, Py_ssize_t substeps,
) except -1
