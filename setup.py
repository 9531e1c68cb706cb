"""Build of the compiled kernels and of the man pages; pyproject.toml declares everything else.

Each `scarid_cli/kernels/NAME.py` with a `NAME.pxd` beside it becomes an extension. Without a
working C compiler the build goes on with a warning, makes a wheel for any machine, and the same
files run interpreted. What Cython adds to every kernel (memory views) is one module, `_shared`:
without it the build takes three times as long.
"""

import os
import subprocess
import sys
import sysconfig
import tempfile
import warnings
from distutils.ccompiler import new_compiler
from distutils.errors import CCompilerError, DistutilsExecError
from distutils.sysconfig import customize_compiler
from pathlib import Path

import Cython
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

BUILD = Path("build/cython", Cython.__version__)  # files of two versions do not go together
SHARED = "_shared"
PACKAGE = "scarid_cli.kernels"


def extension(name: str, source: Path) -> Extension:
    """A module of the kernels: its bits are those of the interpreted file."""
    return Extension(
        f"{PACKAGE}.{name}",
        [str(source)],
        # No contraction to fused multiply-add: compiled and interpreted bits stay equal.
        # No symbols of debuggers, which are two thirds of a wheel.
        extra_compile_args=["-O3", "-g0", "-ffp-contract=off", *SHORT_LOOPS.get(name, [])],
        define_macros=[("Py_LIMITED_API", "0x030B0000")],
        py_limited_api=True,
    )


def shared() -> Extension:
    """The module of what Cython adds to every kernel."""
    path = BUILD / f"{SHARED}.c"
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        words = [f"--generate-shared={path}", f"--module-name={PACKAGE}.{SHARED}"]
        subprocess.run([sys.executable, "-m", "cython", *words], check=True)
    return extension(SHARED, path)


def compiles() -> bool:
    """Whether a C extension can be compiled and linked here."""
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder, "trial.c")
        source.write_text("#include <Python.h>\nint trial(void) { return 0; }\n", "utf-8")
        compiler = new_compiler()
        customize_compiler(compiler)
        compiler.add_include_dir(sysconfig.get_path("include"))
        try:
            objects = compiler.compile([str(source)], output_dir=folder)
            compiler.link_shared_object(objects, str(Path(folder, "trial.so")))
        except (CCompilerError, DistutilsExecError) as error:
            warnings.warn(f"the kernels are not compiled: {error}", stacklevel=1)
            return False
    return True


def man_pages() -> list[str]:
    """The files of the man pages, written into build/man."""
    sys.path.insert(0, str(Path(__file__).parent))
    from scarid_cli.cli.manual.__main__ import write

    return [str(path) for path in write(Path("build/man"))]


extensions = cythonize(
    [
        extension(pxd.stem, pxd.with_suffix(".py"))
        for pxd in sorted(Path("scarid_cli/kernels").glob("*.pxd"))
    ],
    compiler_directives=DIRECTIVES,
    build_dir=str(BUILD),
    shared_utility_qualified_name=f"{PACKAGE}.{SHARED}",
)
extensions.append(shared())
for module in extensions:
    module.optional = True  # set after cythonize, which does not carry it over

compiled = compiles()
setup(
    ext_modules=extensions if compiled else [],
    data_files=[("share/man/man1", man_pages())],
    options={
        "bdist_wheel": {"py_limited_api": "cp311"} if compiled else {},
        "build_ext": {"parallel": os.cpu_count()},
    },
)
