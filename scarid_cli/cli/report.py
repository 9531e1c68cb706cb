"""scarid report"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from scarid_cli.cli import options

if TYPE_CHECKING:
    from pathlib import Path

    from scarid_cli.cli.job import Job


@click.command(name="report")
@click.argument("files", nargs=-1, metavar="[FILE]...")
@click.option("--html", metavar="FILE", help="Write one self-contained page, with figures.")
@click.option("--markdown", metavar="FILE", help="Write the tables as Markdown.")
@click.option(
    "--published",
    "printed",
    metavar="FILE",
    help="Published values to show beside ours.",
)
@click.option(
    "--repeated",
    is_flag=True,
    help="Files of one name in several folders are repetitions: medians and quartiles.",
)
@click.option("--figures", metavar="FOLDER", help="Write each figure as an SVG file.")
@click.option(
    "--title", default="Identification report", show_default=True, help="Of the documents."
)
@options.common
def command(
    files: tuple[str, ...],
    html: str | None,
    markdown: str | None,
    printed: str | None,
    repeated: bool,
    figures: str | None,
    title: str,
    **rest: Any,
) -> None:
    """Tables and figures of logs, motions, parameters, traces, metrics and predictions.

    \b
      scarid report *.parameters.parquet
      scarid report *.parquet --html report.html --markdown report.md
      scarid identify motion.parquet | scarid report
      scarid report --repeated runs/*/p2smd.cross.metrics.parquet

    A file is named METHOD.EXPERIMENT.KIND.EXTENSION: p2smd.direct.metrics.parquet holds the metrics
    of method p2smd in experiment direct. EXPERIMENT and KIND may be left out. Methods stand in the
    order of the files.

    Prints the tables: estimates with relative standard deviations (paper's Table 2), errors of the
    running estimates (Table 3), quality of the predicted torques per experiment (Tables 4 and 5).
    The page adds the logs beside each other (Fig. 3), velocities and accelerations (Fig. 4), the
    largest relative standard deviation per method (Fig. 5), the estimates over time (Fig. 6),
    actual and predicted torques (Figs. 7 and 8).

    A priori values are those of the robot that the metadata state; a CSV states none and takes
    the robot of another table with the same parameters.

    --html - or --markdown - writes that document to standard output instead of the tables. Reads
    tables of any length in bounded memory.
    """
    import sys
    from pathlib import Path

    from scarid_cli.cli.job import job
    from scarid_cli.errors import UsageFault
    from scarid_cli.reporting import published, results, text
    from scarid_cli.reporting import repeated as repetitions
    from scarid_cli.reporting.content import sections
    from scarid_cli.reporting.documents import documents

    paths = files or ("-",)
    twice = next((path for path in paths if paths.count(path) > 1), None)
    if twice:
        raise UsageFault(f"{twice} is given twice; each table can be read once")
    if html and html == markdown:
        raise UsageFault(f"--html and --markdown both go to {html}; give two files")
    # A report is no table and has no history: its inputs need no digest.
    with job({**rest, "no_history": True}) as run, documents(html, markdown) as (page, plain):
        tables = [results.reportable(run.read(path, None)) for path in paths]
        values = published.read(run.read(printed, "published")) if printed else None
        collected = results.collect(tables, repeated=repeated)
        told = repetitions.sections if repeated else sections
        found = told(collected, values)
        if page or figures:
            from scarid_cli.reporting import page as rendering

            drawn = rendering.figures(found)
            if figures:
                save(run, Path(figures), [section.title for section in found], drawn)
            if page:
                page.write(rendering.html(title, found, drawn, tables).encode())
        if plain:
            plain.write(text.markdown(title, found).encode())
        if "-" not in (html, markdown):
            sys.stdout.write(text.terminal(found))
            sys.stdout.flush()
        if not html and any(not section.rows for section in found):
            run.say("some tables have figures only; see them with --html FILE")


def save(run: Job, folder: Path, titles: list[str], drawn: list[list[str]]) -> None:
    """Each figure as a file."""
    from scarid_cli.reporting import naming

    folder.mkdir(parents=True, exist_ok=True)
    for name, document in naming.figures(titles, drawn):
        run.text(str(folder / name)).write(document)
