"""The recursions over time that numpy cannot vectorise, one per file.

Each kernel is plain Python and runs as it stands. The `.pxd` file beside it declares C types, with
which Cython compiles the same source. Numbers are read from arrays through `float(...)`: that costs
nothing when compiled, and keeps numpy's slower scalars out of the interpreted arithmetic.

The docstring of a function is the one place that says what each number of its arrays is. Callers
read them by name: `filters.kalman.KalmanState`, `differentiators.p2smd.Z1`,
`regression.information.Information`, `inference.prediction.Quality`.
"""
