"""Registries: each module in a folder of algorithms is one choice of an option of a command.

Names and descriptions are read from the files without importing the modules, so that `--help`
stays quick.
"""

from __future__ import annotations

import ast
import importlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

ALGORITHMS = Path(__file__).parents[1]


@dataclass(frozen=True)
class Registry:
    """The modules of one folder below `algorithms`, each of which defines a class `class_name`.

    The module `ed_fir` is the choice `ed-fir`; the module `_2smd` (the name of a module cannot
    begin with a digit) is the choice `2smd`.
    """

    folder: str
    class_name: str
    recommended: dict[str, str] = field(default_factory=dict, hash=False)
    """The choices to begin with, and what for."""

    @property
    def names(self) -> list[str]:
        """All choices, sorted."""
        stems = (path.stem for path in (ALGORITHMS / self.folder).glob("*.py"))
        return sorted(_name(stem) for stem in stems if not stem.startswith("__"))

    def load(self, name: str) -> Any:
        """Import the module of a choice and return its class."""
        module = f"scarid_cli.algorithms.{self.folder}.{_stem(name)}"
        return getattr(importlib.import_module(module), self.class_name)

    def describe(self, name: str) -> str:
        """The docstring of the module of a choice."""
        path = ALGORITHMS / self.folder / f"{_stem(name)}.py"
        return ast.get_docstring(ast.parse(path.read_text("utf-8"))) or ""

    def summary(self, name: str) -> str:
        """The first line of the docstring of a choice, and what it is recommended for."""
        use = self.recommended.get(name)
        return self.describe(name).splitlines()[0].removesuffix(".") + (
            f" (recommended {use})." if use else "."
        )


def _name(stem: str) -> str:
    return stem.lstrip("_").replace("_", "-")


def _stem(name: str) -> str:
    stem = name.replace("-", "_")
    return f"_{stem}" if stem[0].isdigit() else stem


DIFFERENTIATORS = Registry(
    "differentiators",
    "Differentiator",
    {
        "kalman": "online",
        "kalman-lag": "online if rows may be late",
        "rts": "for complete logs",
    },
)
ESTIMATORS = Registry("estimators", "Estimator", {"gls": "for complete logs", "rls": "online"})
EXCITATIONS = Registry("excitations", "Excitation", {"spline": "with --optimise"})
