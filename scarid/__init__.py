"""The commands of scarid as functions on tables, for notebooks and scripts.

    import scarid

    log = scarid.read("log.csv")
    found = scarid.identify(log, robot="arm.toml")
    print(found.verdict, found["mass"])

Each function is the command of its name, and does what the command does: the options are those of
the command line with underscores, the tables are the same to the last bit, and an error has the
same line. A table may be a path, an earlier result, a pandas or polars frame, an Arrow table, or a
dictionary of columns. `help(scarid.identify)` lists the options.
"""

from __future__ import annotations

from typing import Any

from scarid.calls import COMMANDS, function
from scarid.results import Checked, Judged, Log, RequirementError, Text
from scarid_cli import __version__
from scarid_cli.errors import BadData, OutputFailure, ScaridError, UsageFault

__all__ = [
    "BadData",
    "Checked",
    "Log",
    "OutputFailure",
    "Judged",
    "RequirementError",
    "ScaridError",
    "Text",
    "UsageFault",
    "__version__",
    *COMMANDS,
]


def __getattr__(name: str) -> Any:
    """The function of a command, made when it is first asked for."""
    if name not in COMMANDS:
        raise AttributeError(f"module 'scarid' has no attribute {name!r}")
    made = globals()[name] = function(name)
    return made


def __dir__() -> list[str]:
    return sorted(__all__)
