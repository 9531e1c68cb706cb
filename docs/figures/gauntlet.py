"""The gauntlet as a heat map: 40 conditions, four robots, and three questions about each.

make gauntlet

The study takes an hour; its tables are kept in docs/gauntlet/tables.md, and are read from there.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from figures import common
from figures.common import ROOT, Data
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

TABLES = ("## scara2 and planar2-gravity, 100 logs each", "## UR10 and Panda, 20 logs each")
ROBOTS = ("scara2", "planar2-gravity", "ur10", "panda")
# The same on light and on dark pages, from good to bad.
SHADES = ("#cfe2f3", "#f6e7bd", "#f1b184", "#dc7650")
CELL_INK = "#111111"
# Of each question: the column, its title, and the ends of the shades.
COVERAGE, WRONG, ERROR = "coverage", "wrong", "/ hindsight"
TITLES = {
    COVERAGE: "95 % intervals that\ncontain the truth [%]",
    WRONG: "good although\nwrong [% of logs]",
    ERROR: "error, blind / best\ncut-off in hindsight",
}
MEANING = {
    COVERAGE: ("94 and more", "90 to 93", "80 to 89", "less"),
    WRONG: ("up to 5", "up to 10", "up to 20", "more"),
    ERROR: ("up to 1.1", "up to 1.3", "up to 2", "more"),
}


def data() -> Data:
    """Of each condition and robot the three columns, as the page prints them."""
    text = (ROOT / "docs" / "gauntlet" / "tables.md").read_text("utf-8")
    found: Data = {}
    for title in TABLES:
        section = text[text.index(title) :].split("\n## ")[0]
        headers, *rows = [_cells(line) for line in section.split("\n") if line.startswith("| ")]
        for row in rows:
            cells = dict(zip(headers, row, strict=True))
            condition = re.sub(r"\b1 samples", "1 sample", cells["condition"])
            found.setdefault(condition, {})[cells["robot"]] = [cells[name] for name in TITLES]
    return found


def _cells(line: str) -> list[str]:
    return [cell.strip() for cell in line.strip("|").split("|")]


def shade(column: str, value: float) -> int:
    """The number of the shade, from 0 (good) to 3."""
    if column == COVERAGE:
        return sum(value < limit for limit in (93.5, 89.5, 79.5))
    limits = (5.0, 10.0, 20.0) if column == WRONG else (1.1, 1.3, 2.0)
    return sum(value > limit for limit in limits)


def drawn(found: Data) -> Figure:
    """A block of four columns for each question."""
    figure, blocks = common.panels(1, 3, 1.3 + 0.165 * len(found), sharey=True)
    for number, (axes, column) in enumerate(zip(blocks, TITLES, strict=True)):
        _block(axes, found, column, number)
    blocks[0].set_yticks([k + 0.5 for k in range(len(found))], list(found))
    return figure


def _block(axes: Axes, found: Data, column: str, number: int) -> None:
    for row, robots in enumerate(found.values()):
        for place, robot in enumerate(ROBOTS):
            if robot in robots:
                _cell(axes, (place, row), column, robots[robot][number])
    axes.set(xlim=(0, len(ROBOTS)), ylim=(len(found), 0))
    names = [robot.replace("planar2-gravity", "planar2") for robot in ROBOTS]
    axes.set_xticks([k + 0.5 for k in range(len(ROBOTS))], names, fontsize=6.5)
    axes.tick_params(length=0, top=False, labeltop=True, labelbottom=False)
    axes.grid(visible=False)
    axes.spines[:].set_visible(False)
    axes.set_title(TITLES[column], fontsize=8, fontweight="bold")
    patches = [Patch(facecolor=colour, edgecolor="none") for colour in SHADES]
    axes.legend(patches, MEANING[column], ncols=2, loc="upper center", bbox_to_anchor=(0.5, 0.0),
                fontsize=6.5, handlelength=1.2, columnspacing=1.0)  # fmt: skip


def _cell(axes: Axes, place: Sequence[int], column: str, text: str) -> None:
    x, y = place
    try:
        colour = SHADES[shade(column, float(text))]
    except ValueError:  # a dash: no log of this cell was identified
        colour = "#e4e4e4"
    axes.add_patch(Rectangle((x + 0.03, y + 0.06), 0.94, 0.88, facecolor=colour, edgecolor="none",
                             clip_on=False))  # fmt: skip
    axes.text(x + 0.5, y + 0.53, text, ha="center", va="center", fontsize=6, color=CELL_INK)
