"""Make the figures of these names, or all: `python -m figures [--redraw] [NAME]...` in docs/."""

from __future__ import annotations

import importlib
import sys

from figures.common import FIGURES, make, redraw

NAMES = sorted(p.stem for p in FIGURES.glob("[a-z]*.py") if p.stem != "common")


def main(words: list[str]) -> None:
    """Run the commands and draw; with --redraw, draw the data that are kept."""
    wanted = [word for word in words if word != "--redraw"] or NAMES
    for name in wanted:
        print(f"docs/figures/{name}.svg", flush=True)
        module = importlib.import_module(f"figures.{name}")
        redraw(module) if "--redraw" in words else make(module)


if __name__ == "__main__":
    main(sys.argv[1:])
