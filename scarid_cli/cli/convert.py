"""scarid convert"""

from __future__ import annotations

from typing import Any

import click

from scarid_cli.cli import options


@click.command(name="convert")
@options.table_input
@click.option(
    "--map",
    "mappings",
    multiple=True,
    metavar="NEW=OLD[,NEW=OLD...]",
    help="Rename columns to what the commands expect: q1, tau1, t, ...; repeatable.",
)
@click.option(
    "--unit",
    "units",
    multiple=True,
    metavar="COLUMNS=UNIT",
    help="The unit that columns have in the log (deg, rpm, mN m, ms, ...; * and ? match), to be "
    "turned into rad, N m, s; repeatable.",
)
@click.option(
    "--rate", type=float, help="Give a log without a time column t one, at this rate [Hz]."
)
@click.option(
    "--robot",
    metavar="FILE",
    help="A robot whose description says what its logs hold (columns, units, motors or joints).",
)
@click.option("--separator", metavar="CHAR", default="", help="Of the values of a CSV, such as ;.")
@click.option("--decimal-comma", is_flag=True, help="A CSV whose numbers have a comma for a point.")
@click.option(
    "--header", metavar="NAMES", default="", help="Names of a CSV that begins with numbers."
)
@options.table_output
@options.common
def command(
    file: str,
    mappings: tuple[str, ...],
    units: tuple[str, ...],
    rate: float | None,
    robot: str | None,
    separator: str,
    decimal_comma: bool,
    header: str,
    **rest: Any,
) -> None:
    """Change the format of a table, or make a table of a lab's log.

    \b
      scarid convert log.csv -o log.parquet
      scarid convert log.parquet | head
      scarid convert --map 'q1=joint_1_pos,tau1=effort_1' --unit 'q*=deg' robot.csv -o log.parquet
      scarid convert --separator ';' --decimal-comma --header t,q1,tau1 export.txt
      scarid convert --rate 500 measured.mat -o log.parquet
      scarid convert --robot mine.toml motors.csv | scarid differentiate

    CSV, Parquet, Arrow stream and Arrow file, in and out; in only: NumPy's .npz and MATLAB's .mat
    (before version 7.3), whose matrices become q1, q2, ... Numbers are kept exactly. CSV carries no
    metadata: units and history end there.

    With --robot, columns, units and rate are those of [log] in the robot's TOML file, unless they
    are given here too, and angles, torques or currents of motors become positions and torques of
    joints, by the gear ratios, couplings and torque constants there: see docs/robots.md.
    """
    from scarid_cli.cli.job import job
    from scarid_cli.cli.pairs import pair, renamings
    from scarid_cli.errors import UsageFault
    from scarid_cli.io.foreign import ARCHIVES, Customs, read_archive
    from scarid_cli.stages.adapt import adapted

    if rate is not None and not 0.0 < rate < float("inf"):
        raise UsageFault(f"--rate must be positive, not {rate:g}")
    if len(separator) > 1 and separator != "\\t":
        raise UsageFault(f"--separator is one character, not {separator!r}")
    if decimal_comma and not separator:
        raise UsageFault("--decimal-comma needs a --separator other than the comma")
    names = renamings(mappings)
    wanted = [pair(text, "--unit") for text in units]
    foreign = separator or header
    with job(rest) as run:
        out = run.output(rest["output"], rest["format"])
        if file.endswith(ARCHIVES):
            table = read_archive(run.noted(file))
        elif foreign:
            comma = "," if decimal_comma else ""
            mark = "\t" if separator == "\\t" else separator
            table = run.read(file, None, through=lambda s: Customs(s, mark, comma, header))
        else:
            table = run.read(file, None)
        if robot:
            from scarid_cli.algorithms.robots.reading import load
            from scarid_cli.stages.joints import as_described

            table = as_described(table, load(robot), names, wanted, rate)
        else:
            table = adapted(table, names, wanted, rate)
        run.write(run.recorded(table), out)
