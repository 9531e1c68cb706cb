"""The declaration of `scarid convert`."""

from __future__ import annotations

import click

from scarid_cli.cli.declaring import options, selecting
from scarid_cli.cli.declaring.declare import declare
from scarid_cli.cli.declaring.headings import heading
from scarid_cli.io.roles import ROLES


@declare("convert")
@options.log_input
@heading("Names and units")
@click.option(
    "--from",
    "recorder",
    type=click.Choice(("ur-rtde", "aurt", "libfranka", "plotjuggler", "lerobot", "unitree")),
    help="Whose column names the log has.  [default: found from them]",
)
@click.option(
    "--map",
    "mappings",
    multiple=True,
    metavar="NEW=OLD[,NEW=OLD...]",
    help="Rename columns to what the commands expect: q1, tau1, t, ...; 'q*=name' renames name1, "
    "name2, ... to q1, q2, ...; repeatable.",
)
@click.option(
    "--unit",
    "units",
    multiple=True,
    metavar="COLUMNS=UNIT",
    shell_complete=options.offered("columns"),
    help="The unit of columns in the log (deg, rpm, mN m, ms, ...), which are converted to rad, "
    "N m, s; * and ? match any name; repeatable.",
)
@click.option("--rate", type=options.RATE, help="Add a time column t at this rate [Hz].")
@click.option(
    "--joints",
    metavar="NAMES",
    default="",
    help="The names of the joints, in order, where the log has names.  [default: those of --robot]",
)
@click.option(
    "--robot",
    type=options.ROBOT,
    metavar="FILE",
    help="The robot of the log: joints in the order of its axes, and what its description says of "
    "its logs (columns, units, motors).",
)
@click.option(
    "--unwrap",
    is_flag=True,
    help="Add the turns that positions and torques lack: of angles that wrap, and of counters.",
)
@click.option(
    "--despike",
    is_flag=True,
    help="Put nan for single positions and torques that leap away and return; `scarid resample "
    "--missing drop` interpolates them.",
)
@heading("The file")
@click.option(
    "--beside",
    multiple=True,
    type=options.InputFile(roles=ROLES),
    metavar="FILE",
    help="Another log with the same rows, whose columns are added; as tau=FILE they are called "
    "tau1, tau2, ... (or q, dq, current, q_ref); repeatable.",
)
@click.option(
    "--topic",
    metavar="NAME",
    help="The topic of a ROS recording.  [default: the only one with positions of joints]",
)
@click.option(
    "--torque-topic", metavar="NAME", help="Another topic, whose efforts are joined to the rows."
)
@click.option(
    "--join",
    type=click.Choice(("linear", "hold")),
    default="linear",
    show_default=True,
    help="How these efforts are brought to the times of the rows: interpolated, or the last one.",
)
@click.option(
    "--separator",
    metavar="CHAR",
    default="",
    help="The separator of values, such as ; or \\t, or a space for any white space.  [default: "
    "found from the first lines]",
)
@click.option("--decimal-comma", is_flag=True, help="The CSV has decimal commas.")
@click.option(
    "--header", metavar="NAMES", default="", help="The column names of a log without a header."
)
@selecting.window
@options.table_output
@options.common
def command() -> None:
    """Convert between table formats, or turn a recorded log into a table.

    \b
      scarid convert log.csv -o log.parquet
      scarid convert log.parquet | head
      scarid convert --from-time 1 --to-time 4 log.csv -o part.parquet
      scarid convert --map 'q1=encoder_a,tau1=load_a' --unit 'q*=deg' robot.csv -o log.parquet
      scarid convert --separator ';' --decimal-comma --header t,q1,tau1 export.txt
      scarid convert positions.txt --beside torques.txt --map 'q*=positions,tau*=torques' --rate 500
      scarid convert --rate 500 measured.mat -o log.parquet
      scarid convert --robot mine.toml motors.csv | scarid differentiate
      scarid convert --robot arm.urdf recording.mcap -o log.parquet

    Reads and writes CSV, Parquet, Arrow streams and Arrow files. It also reads NumPy's .npz and
    .npy and MATLAB's .mat files (those of version 7.3, as HDF5, with the extra `hdf5`), whose
    matrices become the columns q1, q2, ..., or log.q1, log.q2, ... if they are in a structure.
    Every number is kept exactly. CSV has no metadata: units and history are lost there.

    The separator of a text log, decimal commas, names in a comment, lines before the header, and
    units in names (q1 [deg], t_ms) or below them are found from its first lines and reported. Known
    recorders are recognised by their columns (--from), and other names by their words:
    arm_2_joint_position, effort_0, Time (s). What is ambiguous keeps its name, or is refused. Dates
    and times of the day become seconds since the first one.

    --unwrap and --despike hold the log in memory. What they did is reported, with the rows.

    Recordings of ROS (MCAP, rosbag2 and ROS 1; extra `logs`) are read from topics of the types
    JointState, JointTrajectoryControllerState and JointTrajectory. Joints are matched by name.
    Time is that of the messages' stamps, from 0; without stamps, that of their receipt.

    With --robot, columns, units and rate are those in [log] of the robot's TOML file, unless they
    are given here as well. Angles, torques or currents of motors become positions and torques of
    joints by the gear ratios, couplings and torque constants of the file (docs/robots.md).
    """
