"""The declaration of `scarid plot`."""

from __future__ import annotations

import click

from scarid_cli.cli.declaring import options, selecting
from scarid_cli.cli.declaring.declare import declare
from scarid_cli.cli.declaring.headings import DATA, heading


@declare("plot")
@options.table_input
@heading(DATA)
@click.option(
    "--columns",
    metavar="NAMES",
    help="Draw these columns, separated by commas, with patterns such as 'tau*'.  [default: those "
    "that this kind of table is for]",
)
@click.option(
    "--spectrum",
    is_flag=True,
    help="Draw amplitude spectra [unit/sqrt(Hz)] over the frequency; the rate must be constant.",
)
@selecting.window
@options.side_output(
    "-o",
    "--output",
    "place",
    help="Write the plot to FILE, .svg or .png.  [default: draw it on standard output]",
)
@options.common
def command() -> None:
    """Draw a table: a quick look from the shell, on the terminal or as an SVG or a PNG.

    \b
      scarid plot log.csv
      scarid differentiate log.csv then plot --columns 'ddq*'
      scarid identify --robot scara2 log.csv then plot
      scarid plot --spectrum --columns 'tau*' log.csv
      scarid plot log.csv -o log.svg

    \b
    measurements   positions and torques of each joint, with the reference
    motions        velocities and accelerations, with the truth if it is there
    predictions    measured and predicted torques, and the residuals
    traces         each parameter over time
    parameters, payloads, gains
                   a forest: each estimate with its 95 % interval, the bar in
                   percent of the estimate; a bar that ends in an arrow at
                   -100 % contains zero
    others         every column of numbers

    Tables of any length are read in bounded memory: each part of a long record is drawn from its
    least to its greatest value, so that no peak is lost. Rows that a soft sensor has not settled in
    are left out, as in `scarid report`. The plot is as wide as the terminal ($COLUMNS elsewhere,
    or 80 characters), and needs no colours. An SVG follows the light or dark setting of a browser.
    """
