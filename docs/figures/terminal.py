"""An identification as a terminal shows it, and the intervals of its parameters.

scarid identify --robot scara2 samples/scara2.csv -o parameters.parquet
scarid plot parameters.parquet

Between the commands are all the lines that they leave on a terminal of 96 columns.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
import pty
import re
import struct
import subprocess
import sys
import termios

from figures import common
from figures.common import GREY, INK, PALETTE, Data
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch

WIDTH, LINE = 96, 0.16  # columns; inches
SIZE = 0.6  # of a letter of the font: its width, of its size
CONTROL = re.compile(r"\x1b\[[0-9;?]*[A-Za-z]")
PROGRESS = "settings tried"
PART = re.compile(r"\S+(?: \S+)*")  # words that stand together
VERDICT = re.compile(r"(scarid identify: )(good)(: .*)")
GREEN = PALETTE[2]


def data() -> Data:
    """The lines that each command leaves on the terminal."""
    words = [line for line in (__doc__ or "").split("\n") if line.startswith("scarid ")]
    with common.shell():
        return {"screens": [{"command": line, "lines": seen(line)} for line in words]}


def seen(line: str) -> list[str]:
    """What a terminal shows of a command, without the progress that it has overwritten."""
    terminal, inside = pty.openpty()
    fcntl.ioctl(inside, termios.TIOCSWINSZ, struct.pack("HHHH", 50, WIDTH, 0, 0))
    environment = {**os.environ, "PYTHONPATH": str(common.ROOT), "TERM": "xterm-256color"}
    environment["COLUMNS"] = str(WIDTH)  # which comes before what the terminal says
    environment.pop("NO_COLOR", None)
    words = [sys.executable, "-m", "scarid_cli", *line.split()[1:]]
    text = b""
    with subprocess.Popen(words, stdin=inside, stdout=inside, stderr=inside, env=environment):
        os.close(inside)
        with contextlib.suppress(OSError):  # how Linux says that the other end is closed
            while block := os.read(terminal, 1 << 16):
                text += block
    os.close(terminal)
    shown = CONTROL.sub("", text.decode()).split("\n")
    lines = [line.rstrip("\r").rpartition("\r")[2].rstrip() for line in shown]
    kept = [line for line in lines if line and PROGRESS not in line]
    return [line[at : at + WIDTH] for line in kept for at in range(0, len(line), WIDTH)]


def drawn(found: Data) -> Figure:
    """The lines in a frame, each word in its column whatever the font."""
    lines: list[tuple[str, str]] = []
    for screen in found["screens"]:
        lines += [(f"$ {screen['command']}", "bold"), *((x, "normal") for x in screen["lines"])]
    height = LINE * (len(lines) + 1.5)
    figure = Figure(figsize=(common.FIGURE_WIDTH, height))
    letter = 72.0 * common.FIGURE_WIDTH / (WIDTH + 4) / SIZE
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    axes.set(xlim=(-2, WIDTH + 2), ylim=(len(lines) + 0.75, -0.75))
    axes.add_patch(
        FancyBboxPatch(
            (-0.9, -0.2), WIDTH + 1.8, len(lines) + 0.4, boxstyle="round,pad=0.3",
            facecolor="none", edgecolor=GREY, linewidth=0.8, mutation_aspect=0.5,
        )
    )  # fmt: skip
    for row, (line, weight) in enumerate(lines):
        for part, at, colour in parts(line):
            axes.text(
                at, row + 0.5, part, color=colour, fontweight=weight, fontsize=letter,
                family=["DejaVu Sans Mono", "monospace"], va="center",
            )  # fmt: skip
    return figure


def parts(line: str) -> list[tuple[str, int, str]]:
    """The words of a line that stand together, their columns, and their colours."""
    if match := VERDICT.fullmatch(line):
        colours = (INK, GREEN, INK)
        return [(match[k], match.start(k), colours[k - 1]) for k in (1, 2, 3)]
    return [(match[0], match.start(), INK) for match in PART.finditer(line)]
