"""Build of the compiled kernels; everything else is declared in pyproject.toml.

Each `scarid_cli/kernels/NAME.py` with a `NAME.pxd` beside it becomes an extension. Without a
working C compiler the build goes on with a warning, and the same file runs interpreted.
"""

import os
from pathlib import Path

from Cython.Build import cythonize
from setuptools import Extension, setup

DIRECTIVES = {
    "language_level": 3,
    "boundscheck": False,
    "wraparound": False,
    "cdivision": True,
    "initializedcheck": False,
}

# Loops as short as a regressor has columns: the checks before vectors cost more than they save.
SHORT_LOOPS = {"information": ["-fno-tree-vectorize"]}

extensions = cythonize(
    [
        Extension(
            f"scarid_cli.kernels.{pxd.stem}",
            [str(pxd.with_suffix(".py"))],
            # No contraction to fused multiply-add: compiled and interpreted bits stay equal.
            extra_compile_args=["-O3", "-ffp-contract=off", *SHORT_LOOPS.get(pxd.stem, [])],
            define_macros=[("Py_LIMITED_API", "0x030B0000")],
            py_limited_api=True,
        )
        for pxd in sorted(Path("scarid_cli/kernels").glob("*.pxd"))
    ],
    compiler_directives=DIRECTIVES,
    build_dir="build/cython",
)
for extension in extensions:
    extension.optional = True  # set after cythonize, which does not carry it over

setup(
    ext_modules=extensions,
    options={
        "bdist_wheel": {"py_limited_api": "cp311"},
        "build_ext": {"parallel": os.cpu_count()},
    },
)
