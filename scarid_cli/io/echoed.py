"""Messages as `ros2 topic echo --csv` prints them: no header, arrays value after value."""

from __future__ import annotations

from collections.abc import Sequence

from scarid_cli.io.cells import NUMERIC

STAMP = ("sec", "nanosec")
ARRAYS = ("position", "velocity", "effort")  # of sensor_msgs/msg/JointState, in this order


def joint_state_names(fields: Sequence[str]) -> tuple[str, ...]:
    """The names of the columns of a JointState, from its first row; empty if this is none.

    The row is: seconds, nanoseconds, the frame, the names of n joints, and n positions, velocities
    and efforts, of which the later ones may be missing.
    """
    if len(fields) < len(STAMP) + 3 or not all(field.isdecimal() for field in fields[:2]):
        return ()
    rest = fields[len(STAMP) + 1 :]
    joints = next((i for i, field in enumerate(rest) if NUMERIC.match(field)), 0)
    arrays, over = divmod(len(rest) - joints, joints) if joints else (0, 1)
    numbers = all(NUMERIC.match(field) for field in rest[joints:])
    if over or not numbers or not 1 <= arrays <= len(ARRAYS) or not all(rest[:joints]):
        return ()
    if len({*rest[:joints]}) < joints:
        return ()
    signals = [f"{joint}_{array}" for array in ARRAYS[:arrays] for joint in rest[:joints]]
    return (*STAMP, "frame_id", *(f"name{i + 1}" for i in range(joints)), *signals)
