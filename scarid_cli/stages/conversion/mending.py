"""One pipe that mends what the checks of a log found, as far as their advice is a command.

The commands stand in the advice of the findings, between backticks; those with a gap to fill in are
left to the user. A pipe is shown only with what it does not mend.
"""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterable, Sequence
from math import prod

from scarid_cli.algorithms.checks.finding import OK, Finding
from scarid_cli.stages.conversion.units import scale_of

COMMAND = re.compile(r"`scarid (convert|resample)((?: [^`]*)?)`")
ALIGN = "`scarid identify --align` fits it"  # which identify does by itself


def pipe(findings: Iterable[Finding], log: str, robot: str | None) -> tuple[str, list[Finding]]:
    """The pipe for a log, `-` for standard input, and the findings that it leaves.

    `robot` is the file whose [log] names the columns of this log. Empty if no command helps.
    """
    options: dict[str, list[list[str]]] = {"convert": [], "resample": []}
    left = []
    for finding in findings:
        commands = [] if finding.status == OK else COMMAND.findall(finding.advice)
        known = [(name, _options(words)) for name, words in commands if not _open(words)]
        for name, own in known:
            options[name] += [option for option in own if option not in options[name]]
        if finding.status != OK and not known and ALIGN not in finding.advice:
            left.append(finding)
    options = _with_one_clock(**options)
    stages = [[name, *_joined(own)] for name, own in options.items() if own]
    if not stages:
        return "", left
    if robot and stages[0][0] == "convert":
        stages[0] += ["--robot", robot]
    elif robot:
        stages.insert(0, ["convert", "--robot", robot])
    stages[0] += [] if log == "-" else [log]
    return " | ".join(f"scarid {shlex.join(stage)}" for stage in stages), left


def _with_one_clock(
    convert: list[list[str]], resample: list[list[str]]
) -> dict[str, list[list[str]]]:
    """The options with one unit of the time, where a second finding multiplies that of the first.

    The rate of `resample` is that of the first one. Rows that are counted have no other time.
    """
    units = [x for x in convert if x[:1] == ["--unit"] and x[1].startswith("t=")]
    rest = [option for option in convert if option not in units]
    if any(option[:1] == ["--rate"] for option in rest):
        units = []
    if len(units) > 1:
        scales = [scale for _, text in units if (scale := scale_of(text.removeprefix("t=")))]
        further = prod(factor for factor, _ in scales[1:])
        units = [["--unit", f"t={scales[0][0] * further:.6g} s"]]
        resample = [
            ["--rate", f"{float(x[1]) / further:.6g}"] if x[:1] == ["--rate"] else x
            for x in resample
        ]
    return {"convert": [*rest, *units], "resample": resample}


def _open(words: str) -> bool:
    """Whether a part is left to the user."""
    parts = shlex.split(words)
    return bool(parts) and (parts[-1] == "--map" or any("=X" in part for part in parts))


def _options(words: str) -> list[list[str]]:
    """The options, each with its value; a command without any is one empty option."""
    found: list[list[str]] = []
    for word in shlex.split(words):
        if word.startswith("--"):
            found.append([word])
        else:
            found[-1].append(word)
    return found or [[]]


def _joined(options: Sequence[Sequence[str]]) -> list[str]:
    return [word for option in options for word in option]
