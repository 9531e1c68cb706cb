"""The declaration of `scarid info`."""

from __future__ import annotations

from scarid_cli.cli.declaring import options, selecting
from scarid_cli.cli.declaring.declare import declare


@declare("info")
@options.log_input
@options.log_robot
@selecting.window
@options.as_json
@options.common
def command() -> None:
    """Describe a table: kind, columns with units and extremes, sampling, metadata and history.

    \b
      scarid info log.parquet
      scarid info recording.mcap
      scarid trajgen --format arrow | scarid info
      scarid info --json log.parquet | jq '.columns[] | select(.missing > 0) | .name'

    Reads the whole table, in bounded memory. The kind of a CSV is inferred from its columns. Each
    column is shown with its least and greatest value and the number of missing ones. Of a ROS
    recording (MCAP, rosbag2, ROS 1) it lists the topics, with types, counts and rates.
    """
