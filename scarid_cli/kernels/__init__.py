"""The recursions over time, one per file, that numpy cannot vectorise.

Each is plain Python and runs as it stands. A `.pxd` beside it gives C types, with which Cython
compiles the same source. Numbers leave the arrays through `float(...)`, which costs nothing
compiled and keeps numpy's slower scalars out of the interpreted arithmetic.
"""
