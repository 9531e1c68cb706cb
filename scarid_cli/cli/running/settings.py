"""Files of settings: what `scarid tune` saves and `scarid differentiate --settings` takes."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass

from scarid_cli.algorithms.robots.files import text_of
from scarid_cli.errors import BadData, UsageFault

PerJoint = dict[str, list[float]]  # the values of each setting, one per joint


@dataclass(frozen=True)
class SavedSettings:
    """The content of a file of settings: the best method, and the settings of each method."""

    path: str
    best: str
    methods: dict[str, PerJoint]

    def names(self, method: str) -> list[str]:
        """The settings that the file has for a method."""
        if method not in self.methods:
            raise UsageFault(
                f"--settings: {self.path} has no settings for {method}, only for "
                f"{', '.join(self.methods) or 'none'}; choose one of these with --method"
            )
        return list(self.methods[method])

    def values(self, method: str, name: str, joints: int) -> list[float]:
        """The values of one setting, which must be one per joint of the log."""
        values = self.methods[method][name]
        if len(values) != joints:
            count = f"{len(values)} value{'s' if len(values) != 1 else ''}"
            raise UsageFault(
                f"--settings: {self.path} has {count} for {joints} joints ({method}, {name}); "
                "run `scarid tune --save` on a log of the same robot"
            )
        return values


def document(best: str, methods: dict[str, PerJoint], origin: str) -> str:
    """The TOML text: the best method, and a table of settings, one value per joint, for each."""
    lines = [f"# {origin}", f'method = "{best}"']
    for method, values in methods.items():
        lines += ["", f"[{method}]"]
        lines += [f"{name} = [{', '.join(map(repr, v))}]" for name, v in values.items()]
    return "\n".join(lines) + "\n"


def read(path: str) -> SavedSettings:
    """Read a file of settings."""
    try:
        content = tomllib.loads(text_of(path))
        best = content.pop("method")
        methods = {
            method: {name: [float(x) for x in values] for name, values in table.items()}
            for method, table in content.items()
        }
    except (AttributeError, KeyError, TypeError, ValueError):
        raise BadData(
            f"{path}: this is not a file of settings; make one with `scarid tune --save`"
        ) from None
    return SavedSettings(path, best, methods)
