"""What the figures share: commands in an empty folder, thinned curves, kept data and the SVG."""

from __future__ import annotations

import hashlib
import json
import os
import re
import shlex
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from matplotlib import rcParams
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from scarid_cli.arrays import Array
from scarid_cli.reporting import figures, shades
from scarid_cli.reporting.curves import extremes
from scarid_cli.reporting.figures import FIGURE_WIDTH, INK, PALETTE, plain_powers

__all__ = ["INK", "PALETTE", "Array", "Axes", "plain_powers"]

FIGURES = Path(__file__).parent
ROOT = FIGURES.parent.parent
POINTS = 200  # of a curve: as many as can be told apart
DIGITS = 5  # of a number in the kept data
GREY = "#888888"

Data = dict[str, Any]


@contextmanager
def shell() -> Iterator[Callable[[str], str]]:
    """Run lines of a shell in a folder that has the samples; gives what each printed."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "samples").symlink_to(ROOT / "samples")
        start = (
            f'scarid() {{ {shlex.quote(sys.executable)} -m scarid_cli "$@"; }}; set -o pipefail; '
        )
        environment = {**os.environ, "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1"}

        def run(line: str) -> str:
            done = subprocess.run(
                ["bash", "-c", start + line], cwd=folder, env=environment, text=True,
                capture_output=True, check=False,
            )  # fmt: skip
            if done.returncode:
                raise RuntimeError(f"{line}\n{done.stderr}")
            return done.stdout

        here = Path.cwd()
        os.chdir(folder)
        try:
            yield run
        finally:
            os.chdir(here)


def columns(path: str, *names: str) -> list[Array]:
    """Columns of a table that a command wrote."""
    table: pa.Table = pq.read_table(path, columns=list(names))
    return [table.column(name).to_numpy() for name in names]


def thinned(*curve: Sequence[float] | Array) -> list[list[float]]:
    """Times and values of at most POINTS points, with the extremes of each part."""
    points = np.array(curve, dtype=float)
    part = 2 * points.shape[1] // POINTS
    if part > 2:
        points = extremes(points[:, : points.shape[1] // part * part], part)
    return [rounded(row) for row in points]


def rounded(values: Sequence[float] | Array) -> list[float]:
    """The numbers with DIGITS digits."""
    return [float(f"{x:.{DIGITS}g}") for x in values]


def panels(rows: int, across: int, height: float, **how: Any) -> tuple[Figure, list[Axes]]:
    """A figure of the width of a page, and its panels row by row."""
    figure = Figure(figsize=(FIGURE_WIDTH, height), layout="constrained")
    grid = figure.subplots(rows, across, squeeze=False, **how)
    return figure, list(grid.flatten())


def titled(axes: Axes, title: str) -> None:
    """A title at the left of a panel, and the names of its curves below it."""
    handles, _ = axes.get_legend_handles_labels()
    axes.set_title(title, loc="left", fontsize=8.5, fontweight="bold", pad=16 if handles else 5)
    if handles:
        place = {"loc": "lower left", "bbox_to_anchor": (0.0, 1.0), "borderaxespad": 0.0}
        axes.legend(ncols=len(handles), handlelength=1.0, columnspacing=1.0, borderpad=0.2, **place)


def kept(name: str) -> Data:
    """The data of a figure, as they are kept."""
    found: Data = json.loads((FIGURES / f"{name}.json").read_text("utf-8"))
    return found


def digest(data: Data) -> str:
    """The digest of the data, which the picture names."""
    return hashlib.sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()


def picture(module: ModuleType, data: Data) -> str:
    """The SVG of a figure for light and dark pages, which names the digest of its data."""
    with figures.styled():
        # Half the size, and words can be found.
        rcParams.update({"svg.fonttype": "none", "font.sans-serif": ["DejaVu Sans", "Verdana"]})
        document = figures.svg(module.drawn(data))
    start = document.index("<svg")
    text = shades.both(small(document[start:]))
    return f"{document[:start]}<!-- data {digest(data)} -->\n{text}"


def small(document: str) -> str:
    """The document without what no reader needs."""
    document = re.sub(
        r' transform="rotate\(-0 [^"]*"|<!--.*?-->| id="(?:patch|text)_\d+"', "", document
    )
    document = re.sub(r'(?<= [xy]=")(-?\d+\.\d)\d*', r"\1", document)
    document = re.sub(r'(?<= d=")[^"]*', lambda path: path[0].replace(" \n", " ").strip(), document)
    document = re.sub(r"<g>\s*(<(?:path|text)[^>]*(?:/>|>[^<]*</text>))\s*</g>", r"\1", document)
    return re.sub(r"\n\s+", "\n", document)


def make(module: ModuleType) -> None:
    """Run the commands of a figure, keep the data, and draw it."""
    name = module.__name__.rpartition(".")[2]
    text = json.dumps(module.data(), ensure_ascii=False, separators=(",", ":"))
    (FIGURES / f"{name}.json").write_text(text + "\n", "utf-8")
    redraw(module)


def redraw(module: ModuleType) -> None:
    """Draw a figure from the data that are kept."""
    name = module.__name__.rpartition(".")[2]
    (FIGURES / f"{name}.svg").write_text(picture(module, kept(name)), "utf-8")
