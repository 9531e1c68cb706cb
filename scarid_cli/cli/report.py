"""The declaration of `scarid report`."""

from __future__ import annotations

import click

from scarid_cli.cli.declaring import options
from scarid_cli.cli.declaring.declare import declare


@declare("report")
@click.argument("files", nargs=-1, metavar="[FILE]...", type=options.INPUT)
@options.side_output(
    "-o", "--output", "place", help="Write the printed tables to FILE.  [default: standard output]"
)
@options.side_output("--html", help="Write one self-contained page with tables and figures.")
@options.side_output("--markdown", help="Write the tables as Markdown.")
@options.input_file("--published", help="A table of published values to print beside the results.")
@click.option(
    "--repeated",
    is_flag=True,
    help="Files of the same name in different folders are repetitions of one experiment: print "
    "medians and quartiles.",
)
@click.option(
    "--fleet",
    metavar="FOLDER",
    help="Report the outcome of a batch, which is in FOLDER, in place of FILEs: one row per log.",
)
@options.side_output("--figures", metavar="FOLDER", help="Write each figure as an SVG file.")
@click.option(
    "--title",
    help="Title of the documents.  [default: Identification of ROBOT, with --fleet Fleet report]",
)
@options.common
def command() -> None:
    """Print tables and draw figures of logs, motions, parameters, traces, metrics and predictions.

    \b
      scarid report *.parameters.parquet
      scarid report *.parquet --html report.html --markdown report.md
      scarid identify motion.parquet | scarid report
      scarid report --repeated runs/*/p2smd.cross.metrics.parquet
      scarid report --fleet outcome --html outcome/fleet.html

    A file is named METHOD.EXPERIMENT.KIND.EXTENSION: p2smd.direct.metrics.parquet holds the metrics
    of method p2smd in experiment direct. EXPERIMENT and KIND may be left out. Methods appear in the
    order of the files.

    Prints the tables: estimates with relative standard deviations (the paper's Table 2), errors of
    the running estimates (Table 3), and the quality of the predicted torques in each experiment
    (Tables 4 and 5). The page begins with the best method, by how much it is better, and whether it
    may be believed; it shows estimates with their 95 % intervals, measured and predicted torques
    with their residuals, and errors of soft sensors, and its figures can be enlarged. --figures
    draws the logs (Fig. 3), velocities and accelerations (Fig. 4), the largest relative standard
    deviation of each method (Fig. 5), the estimates over time (Fig. 6), and measured and predicted
    torques (Figs. 7 and 8).

    A priori values are those of the robot named in the metadata. CSV has no metadata; a CSV takes
    the robot of another table with the same parameters.

    --fleet prints which robots and logs of a batch need a look. Its page has a row for each log,
    the failures first, which a browser sorts and filters without a network, with links to the pages
    of the logs.

    --html - or --markdown - writes that document to standard output in place of the tables. Tables
    of any length are read in bounded memory.
    """
