"""The commands of scarid as functions on tables (written by `python -m scarid.stubs`)."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

from scarid.results import Checked as Checked
from scarid.results import Judged as Judged
from scarid.results import Log as Log
from scarid.results import RequirementError as RequirementError
from scarid.results import Text as Text
from scarid_cli.errors import BadData as BadData
from scarid_cli.errors import OutputFailure as OutputFailure
from scarid_cli.errors import ScaridError as ScaridError
from scarid_cli.errors import UsageFault as UsageFault

__version__: str

Values = float | str | Sequence[float]
Settings = Mapping[str, Any] | Sequence[str] | str
TableLike = Any  # a path, a Log, a frame of pandas or polars, an Arrow table, or columns

def read(
    *tables: TableLike,
    from_: Literal['ur-rtde', 'aurt', 'libfranka', 'plotjuggler', 'lerobot', 'unitree'] | None = None,
    map: Settings | None = None,
    unit: Settings | None = None,
    rate: Values | None = None,
    joints: Values | None = None,
    robot: TableLike | None = None,
    unwrap: bool | None = None,
    despike: bool | None = None,
    beside: TableLike | None = None,
    topic: Values | None = None,
    torque_topic: Values | None = None,
    join: Literal['linear', 'hold'] | None = None,
    separator: Values | None = None,
    decimal_comma: bool | None = None,
    header: Values | None = None,
    from_time: Values | None = None,
    to_time: Values | None = None,
    rows: Values | None = None,
    no_history: bool | None = None,
) -> Log:
    """Convert between table formats, or turn a recorded log into a table.

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

    Options:
        from_: Whose column names the log has. [default: found from them]
        map: Rename columns to what the commands expect: q1, tau1, t, ...; 'q*=name' renames name1, name2, ... to q1, q2, ...; repeatable.
        unit: The unit of columns in the log (deg, rpm, mN m, ms, ...), which are converted to rad, N m, s; * and ? match any name; repeatable.
        rate: Add a time column t at this rate [Hz].
        joints: The names of the joints, in order, where the log has names. [default: those of --robot]
        robot: The robot of the log: joints in the order of its axes, and what its description says of its logs (columns, units, motors).
        unwrap: Add the turns that positions and torques lack: of angles that wrap, and of counters.
        despike: Put nan for single positions and torques that leap away and return; `scarid resample --missing drop` interpolates them.
        beside: Another log with the same rows, whose columns are added; as tau=FILE they are called tau1, tau2, ... (or q, dq, current, q_ref); repeatable.
        topic: The topic of a ROS recording. [default: the only one with positions of joints]
        torque_topic: Another topic, whose efforts are joined to the rows.
        join: How these efforts are brought to the times of the rows: interpolated, or the last one.
        separator: The separator of values, such as ; or \\t, or a space for any white space. [default: found from the first lines]
        decimal_comma: The CSV has decimal commas.
        header: The column names of a log without a header.
        from_time: Read the log from this time on [s].
        to_time: Read the log up to this time [s].
        rows: Read rows A to B only, counted from 1.
        no_history: Write no history into the metadata.
    """

def trajgen(
    *,
    robot: TableLike | None = None,
    excitation: Literal['fourier', 'quintic', 'sequential', 'spline'] | None = None,
    set: Settings | None = None,
    seed: Values | None = None,
    duration: Values | None = None,
    segment: Values | None = None,
    sequential: bool | None = None,
    via: TableLike | None = None,
    home: Values | None = None,
    approach: Values | None = None,
    repeat: Values | None = None,
    rate: Values | None = None,
    q_max: Values | None = None,
    q_min: Values | None = None,
    dq_max: Values | None = None,
    ddq_max: Values | None = None,
    workspace: Values | None = None,
    optimise: bool | None = None,
    criterion: Literal['balanced', 'd', 'a', 'c', 'scaled-c'] | None = None,
    for_: Values | None = None,
    after: TableLike | None = None,
    budget: Values | None = None,
    starts: Values | None = None,
    expected: Values | None = None,
    torque_noise: Values | None = None,
    drop_slow: Values | None = None,
    align: bool | None = None,
    no_history: bool | None = None,
) -> Log:
    """Generate a trajectory that excites a robot, within its limits.

      scarid trajgen --seed 1 -o reference.parquet
      scarid trajgen --robot emps --duration 30 --segment 1 4 | scarid simulate --robot emps
      scarid trajgen --via points.csv --rate 500
      scarid trajgen --robot arm.urdf --ddq-max 5 --home 0,-0.5 -o reference.csv
      scarid trajgen --robot arm.toml --optimise -o reference.parquet
      scarid trajgen --robot scara2 --seed 1 --expected errors.csv -o reference.parquet
      scarid trajgen --robot arm.toml --optimise --after parameters.parquet -o next.parquet
      scarid trajgen --robot arm.urdf --optimise --for payload -o weigh.parquet

    The motion starts and ends at rest at the home position and stays within the limits on position,
    velocity and acceleration, which are those of the robot's description unless an option narrows
    them. A motion that would leave its limits is refused before anything is written. The
    condition number of the robot's observation matrix W along the motion is reported on standard
    error; about 30 is good for a few parameters, 100 to 1000 for six axes.

    --optimise also keeps the torque limits, computed with the a priori parameters, and keeps links
    apart whose shapes are described. It reports what limits the motion, and the error of each
    parameter to expect from torques with white noise.

    Options:
        robot: The robot: scara2, emps, planar2-gravity, or a .toml or .urdf file. [default: the robot named in the table's metadata, else $SCARID_ROBOT, else scara2]
        excitation: The kind of motion; see below. [default: quintic, or spline with --optimise]
        set: A setting of the excitation; repeatable.
        seed: Seed of the random motion, or of the random starts of --optimise.
        duration: Length of the motion [s].
        segment: Shortest and longest time between via points [s]; short for --set shortest=SHORTEST --set longest=LONGEST. [default: 0.8 2.0]
        sequential: Move one joint at a time, as in the paper; short for --excitation sequential.
        via: Take the via points from a table with columns t, q1, q2, ... instead of random ones.
        home: Position at which the motion starts and ends [rad or m]. [default: zero in the middle half of the limits, else their middle]
        approach: Begin with a slow motion from this posture to the home position [rad or m].
        repeat: How often the motion is repeated.
        rate: Rows per second [Hz].
        q_max: Upper position limit [rad or m]; without --q-min, its negative is the lower one. [default: the robot's]
        q_min: Lower position limit [rad or m]. [default: the robot's]
        dq_max: Limit on |dq| [1/s]. [default: the robot's]
        ddq_max: Limit on |ddq| [1/s2]. [default: the robot's]
        workspace: Box that the tool must not leave, in the frame of the base [m]. Needs --optimise.
        optimise: Find the best motion; see --criterion.
        criterion: What makes a motion the best: a small volume of the error ellipsoid (d), small errors of the torques that parameters stand for (a), a small condition number of W (c) or of its scaled columns (scaled-c), or d and c in equal parts (balanced). Needs --optimise. [default: balanced; d with --for]
        for_: Optimise the errors of these parameters alone, the others being nuisance parameters; or those of the gains of the torques beside one another (`identify --free-gains`); or those of a payload (`payload`). Needs --optimise.
        after: A parameter table of earlier experiments, which the motion is to complement.
        budget: Time for the random starts of --optimise. Needs --optimise. [default: 10]
        starts: Number of random starts instead of a time, which gives the same motion each time. Needs --optimise. [default: as many as --budget allows]
        expected: Write the expected error of each parameter to FILE, a table.
        torque_noise: Standard deviation of the logged torques, for the errors that are predicted [N m or N]. [default: that of --after, else the robot's]
        drop_slow: Predict errors for `identify` with this option, which leaves out rows of slow joints.
        align: Predict errors for `identify` with this option, which also fits a delay. Needs --expected or --optimise.
        no_history: Write no history into the metadata.
    """

def simulate(
    *tables: TableLike,
    robot: TableLike | None = None,
    with_: Settings | None = None,
    encoder_bits: Values | None = None,
    position_noise: Values | None = None,
    torque_noise: Values | None = None,
    seed: Values | None = None,
    control: Literal['pd', 'pid', 'pd-gravity', 'computed-torque'] | None = None,
    bandwidth: Values | None = None,
    kp: Values | None = None,
    kd: Values | None = None,
    ki: Values | None = None,
    soft_sensor: Values | None = None,
    control_rate: Values | None = None,
    substeps: Values | None = None,
    log_rate: Values | None = None,
    truth: bool | None = None,
    realtime: bool | None = None,
    no_history: bool | None = None,
) -> Log:
    """Simulate a robot that follows a trajectory in closed loop, and log its sensors.

      scarid trajgen --seed 1 | scarid simulate --seed 1 -o log.parquet
      scarid simulate --encoder-bits 13 --truth reference.parquet > log.csv
      scarid simulate --with torque-delay=0.002 --with lost-rows=0.001 reference.csv
      scarid simulate --kp 6.5,155 --kd 5,25 reference.csv   # the gains printed in the paper
      scarid trajgen --seed 1 | scarid simulate --soft-sensor p2smd,gamma0=250,gamma1=200
      scarid trajgen --robot arm.urdf --ddq-max 5 | scarid simulate --control pd-gravity
      scarid trajgen --seed 1 --duration 2 | scarid simulate --realtime | scarid differentiate

    The robot has the a priori parameters of its description and starts at rest at the first
    position of the trajectory. With e = q_ref - q, the controllers are (paper eq. 29, its sign
    corrected):

      pd               tau = Kp e + Kd de/dt
      pid              tau = Kp e + Kd de/dt + Ki integral(e)
      pd-gravity       the torque of pid, plus gravity g(q)
      computed-torque  tau = M(q) (ddq_ref + Kp e + Kd de/dt + Ki integral(e)) + h(q, dq) + friction

    where dq is the differentiated and smoothed reading of the encoder, or that of --soft-sensor.
    Gravity, M, h (gravity, centrifugal and Coriolis torques) and the friction at dq_ref are those
    of the description. Gains that the description does not give are found from --bandwidth: two
    equal poles for the typical inertia of each joint. Coulomb friction holds joints at rest. The
    motion is integrated by the Runge-Kutta method of fourth order, whose steps end where a joint
    stops or begins to slide.

    Options:
        robot: The robot: scara2, emps, planar2-gravity, or a .toml or .urdf file. [default: the robot named in the table's metadata, else $SCARID_ROBOT, else scara2]
        with_: An imperfection of the robot, its sensors or its log, one value for all joints or one per joint; repeatable. They are listed below. [default: those of the description]
        encoder_bits: The same as --with encoder-bits=...; 0 for perfect ones. [default: the robot's]
        position_noise: The same as --with position-noise=... [default: the robot's]
        torque_noise: The same as --with torque-noise=... [default: the robot's]
        seed: Seed of the noise.
        control: Controller. [default: the robot's, or computed-torque]
        bandwidth: Bandwidth from which the gains are found [Hz]. [default: the robot's gains, or 5]
        kp: Proportional gains. [default: see --bandwidth]
        kd: Derivative gains. [default: see --bandwidth]
        ki: Integral gains. [default: the robot's; else from --bandwidth for pid, and 0]
        soft_sensor: Close the loop with the velocities of a causal method of `differentiate`, row by row, as in paper eq. 29. How well the loop follows is reported. `preset=NAME` names a preset. [default: the smoothed difference of the readings]
        control_rate: Control rate [Hz].
        substeps: Runge-Kutta steps per period of the controller.
        log_rate: Rows of the log per second [Hz].
        truth: Add the true q, dq, ddq and tau as columns q1_true, ...
        realtime: Write each row when its time has come, as the robot would.
        no_history: Write no history into the metadata.
    """

def resample(
    *tables: TableLike,
    rate: Values | None = None,
    max_gap: Values | None = None,
    robot: TableLike | None = None,
    from_time: Values | None = None,
    to_time: Values | None = None,
    rows: Values | None = None,
    missing: Literal['refuse', 'drop', 'split', 'fill'] | None = None,
    no_history: bool | None = None,
) -> Log:
    """Resample a log with a jittered clock at a constant rate.

      scarid resample --rate 500 log.csv | scarid differentiate
      scarid resample --rate 100 log.parquet -o slow.parquet

    Columns of numbers are interpolated linearly. If the new rate is lower than that of the log,
    they also pass a low-pass without delay: a sinc in a Kaiser window, which attenuates by 60 dB
    above half the new rate and looks eight new periods ahead. Other columns keep the value of the
    previous row. Rows that repeat the time of the previous row are dropped, and so are held
    samples: rows with which a fast logger repeats all measured values of a slower sensor. The mean
    rate, the jitter, the longest interval, dropped rows and gaps are reported on standard error.
    Rows stream through in bounded memory.

    Gaps are never interpolated. After each gap the column `segment` increases by one: filter and
    differentiate restart there, and identify leaves out the settling rows.

    Options:
        rate: The new rate [Hz].
        max_gap: The longest interval to interpolate [s]; a longer one is a gap. [default: 5 periods of the log, or one period of the new rate if that is longer]
        robot: A .toml file of the robot, whose [log] says what the columns are, if they have other names than ours. [default: $SCARID_ROBOT]
        from_time: Read the log from this time on [s].
        to_time: Read the log up to this time [s].
        rows: Read rows A to B only, counted from 1.
        missing: What to do where a value is missing: refuse the log; drop the row; split, which also begins a new segment after it, as after a gap; or fill, for sources that write in turn: keep the rows with q1, and interpolate the other columns there (holds the log in memory).
        no_history: Write no history into the metadata.
    """

def check(
    *tables: TableLike,
    robot: TableLike | None = None,
    strict: bool | None = None,
    fix: bool | None = None,
    from_time: Values | None = None,
    to_time: Values | None = None,
    rows: Values | None = None,
) -> Checked:
    """Check a log before it is identified: its clock, values, units, motion and torques.

      scarid check --robot arm.toml log.csv
      eval "$(scarid check --fix log.csv)" > mended.csv
      scarid check --strict log.parquet && scarid identify log.parquet
      scarid check --json log.csv | jq -r '.checks[] | select(.status != "ok") | .advice'

    The log has time, positions and torques, as for `scarid identify`, but its clock may jitter and
    values may be missing. Each line is a check: ok, warning or failed, what was found, and below it
    what to do. Units, reversed torques and exchanged joints are found with the limits of the
    robot's description and with a first fit of its model, which needs no parameters. A fault
    that one check finds is corrected before the next ones run. Below the count stands the pipe that
    mends what commands can mend. The log is held in memory.

    Exit status: 0, also with warnings; 1 if there are warnings only and --strict is given; 65 if a
    check failed, with --fix if the pipe leaves something that failed.

    Options:
        robot: The robot: scara2, emps, planar2-gravity, or a .toml or .urdf file. [default: the robot named in the table's metadata, else $SCARID_ROBOT, else scara2]
        strict: Exit with 1 if there are warnings only.
        fix: Print the pipe that mends what it can, and nothing else.
        from_time: Read the log from this time on [s].
        to_time: Read the log up to this time [s].
        rows: Read rows A to B only, counted from 1.
    """

def filter(
    *tables: TableLike,
    columns: Values | None = None,
    cutoff: Values | None = None,
    natural_frequency: Values | None = None,
    order: Values | None = None,
    zero_phase: bool | None = None,
    from_time: Values | None = None,
    to_time: Values | None = None,
    rows: Values | None = None,
    missing: Literal['refuse', 'drop', 'split', 'fill'] | None = None,
    no_history: bool | None = None,
) -> Log:
    """Low-pass filter columns of a log.

      scarid filter --cutoff 20 log.csv | scarid differentiate
      scarid filter --natural-frequency 2 -c 'tau*' log.parquet -o filtered.parquet
      scarid filter --zero-phase --cutoff 40 -c q1 log.csv

    The filter is a Butterworth filter (paper section 3.2), causal and streaming unless --zero-phase
    is given. A causal filter delays what it filters, so filter positions and torques alike. A
    zero-phase filter first extends the record at both ends by odd reflection over three times the
    order, as MATLAB's filtfilt does.

    Options:
        columns: The columns to filter, separated by commas; * and ? match any name. [default: all q1, q2, ... and tau1, tau2, ...]
        cutoff: The frequency where the gain is -3 dB [Hz].
        natural_frequency: The natural frequency of the robot; the cut-off is ten times as high, by the paper's rule. [default: 2]
        order: Filter order.
        zero_phase: Filter forwards and backwards: no delay, but offline. Holds the whole log in memory.
        from_time: Read the log from this time on [s].
        to_time: Read the log up to this time [s].
        rows: Read rows A to B only, counted from 1.
        missing: What to do where a value is missing: refuse the log; drop the row; split, which also begins a new segment after it, as after a gap; or fill, for sources that write in turn: keep the rows with q1, and interpolate the other columns there (holds the log in memory).
        no_history: Write no history into the metadata.
    """

def tune(
    *tables: TableLike,
    method: Sequence[Literal['all', '2smd', 'aise', 'algebraic', 'astd', 'backward', 'central', 'deadbeat', 'ed-fir', 'filtering', 'high-gain', 'implicit-levant', 'kalman', 'kalman-lag', 'levant', 'p2smd', 'rts', 'savgol', 'savgol-end', 'spline', 'super-twisting', 'tracking', 'zero-phase']] | Literal['all', '2smd', 'aise', 'algebraic', 'astd', 'backward', 'central', 'deadbeat', 'ed-fir', 'filtering', 'high-gain', 'implicit-levant', 'kalman', 'kalman-lag', 'levant', 'p2smd', 'rts', 'savgol', 'savgol-end', 'spline', 'super-twisting', 'tracking', 'zero-phase'] | None = None,
    robot: TableLike | None = None,
    seed: Values | None = None,
    save: Values | None = None,
    from_time: Values | None = None,
    to_time: Values | None = None,
    rows: Values | None = None,
    missing: Literal['refuse', 'drop', 'split', 'fill'] | None = None,
    no_history: bool | None = None,
) -> Log:
    """Find the settings of differentiators from a log, without knowing the truth.

      scarid tune --robot scara2 log.csv --save log.toml
      scarid differentiate --settings log.toml log.csv
      scarid tune --robot scara2 --to-time 10 --method kalman log.csv --save online.toml
      scarid tune log.csv --save kalman.toml
      scarid tune --method all log.csv | sort -t, -k4 -g | column -s, -t

    With --robot, positions and torques of all joints pass one zero-phase low-pass after another,
    from low to high cut-offs, and parameters are identified behind each. The cut-off is chosen in
    the middle of the range in which the parameters of the parts of the log scatter least. Each
    method then gets the settings that have this bandwidth. A method without a bandwidth, such as a
    sliding-mode differentiator, gets the settings whose derivatives come closest to those of the
    smoother with this bandwidth.

    Without a robot only the positions are used. For the Kalman methods, the noise, the intensity
    and the acceleration process are found by maximum likelihood, the noise being at least that of
    the encoder's resolution. The other methods get the settings whose derivatives come closest to
    those of Kalman smoothers that tune themselves. Vibrations of the arm count as motion here, so
    that a robot with torques is better tuned with --robot.

    All joints get the same settings, because a torque contains the accelerations of all joints.
    Writes the table of all settings that were tried. The same seed gives the same settings. Holds
    the log in memory. Without a robot, only the longest segment of a log with gaps is used.

    Options:
        method: A method of `scarid differentiate` to tune, repeatable; `all` stands for every causal one. The first is what differentiate --settings uses. [default: rts and kalman with --robot, else kalman]
        robot: Choose the bandwidth at which estimates of this robot agree best (see identify --robot).
        seed: Seed of a search.
        save: Write the chosen settings, for differentiate --settings.
        from_time: Read the log from this time on [s].
        to_time: Read the log up to this time [s].
        rows: Read rows A to B only, counted from 1.
        missing: What to do where a value is missing: refuse the log; drop the row; split, which also begins a new segment after it, as after a gap; or fill, for sources that write in turn: keep the rows with q1, and interpolate the other columns there (holds the log in memory).
        no_history: Write no history into the metadata.
    """

def differentiate(
    *tables: TableLike,
    method: Literal['2smd', 'aise', 'algebraic', 'astd', 'backward', 'central', 'deadbeat', 'ed-fir', 'filtering', 'high-gain', 'implicit-levant', 'kalman', 'kalman-lag', 'levant', 'p2smd', 'rts', 'savgol', 'savgol-end', 'spline', 'super-twisting', 'tracking', 'zero-phase'] | None = None,
    set: Settings | None = None,
    settings: TableLike | None = None,
    preset: Values | None = None,
    match: bool | None = None,
    per_joint: bool | None = None,
    velocity: Literal['estimated', 'measured'] | None = None,
    from_time: Values | None = None,
    to_time: Values | None = None,
    rows: Values | None = None,
    missing: Literal['refuse', 'drop', 'split', 'fill'] | None = None,
    no_history: bool | None = None,
) -> Log:
    """Estimate velocities and accelerations from positions (the soft sensor).

      scarid differentiate log.csv | scarid identify
      scarid tune --robot scara2 log.csv --save log.toml
      scarid differentiate --settings log.toml log.csv
      scarid differentiate --method p2smd --preset table1 --no-match log.csv
      scarid differentiate --method p2smd --set gamma0=25 --set gamma1=20 log.csv
      scarid filter --zero-phase --cutoff 20 log.csv | scarid differentiate --method central

    Adds the columns dq1, dq2, ... and ddq1, ddq2, ... for the positions q1, q2, ... Velocities
    that the log has are kept as dq1_measured, ... The default settings suit moves that take a
    second, sampled at 200 Hz with a 16-bit encoder.

    --match passes q and tau through the dynamics of the derivatives and adds the column settled;
    identify and validate leave out the rows where it is 0. Methods with a fixed lag delay each row,
    together with its time. Methods of the whole record hold the log in memory.

    Options:
        method: The method: 2smd, aise, algebraic, astd, backward, central, deadbeat, ed-fir, filtering, high-gain, implicit-levant, kalman, kalman-lag, levant, p2smd, rts, savgol, savgol-end, spline, super-twisting, tracking, zero-phase. `scarid methods NAME` describes one. Recommended: kalman online, kalman-lag online if rows may be late, rts for complete logs. [default: the best of --settings, else kalman]
        set: A setting of the method, one value for all joints or one per joint; repeatable.
        settings: Settings that `scarid tune --save` wrote.
        preset: Named settings; table1 is that of the paper.
        match: Bring all signals of a row to the same instant, and mark the settling rows. [default: --match if the table has torques; the paper's procedure is --no-match]
        per_joint: Allow settings that differ between joints together with --match, for joints that move independently: a torque of an arm contains the accelerations of all joints.
        velocity: `measured` takes the velocities of the log (dq1 or dq1_measured, ...) behind the low-pass of the method, and differentiates these. [default: estimated from the positions]
        from_time: Read the log from this time on [s].
        to_time: Read the log up to this time [s].
        rows: Read rows A to B only, counted from 1.
        missing: What to do where a value is missing: refuse the log; drop the row; split, which also begins a new segment after it, as after a gap; or fill, for sources that write in turn: keep the rows with q1, and interpolate the other columns there (holds the log in memory).
        no_history: Write no history into the metadata.
    """

def identify(
    *tables: TableLike,
    robot: TableLike | None = None,
    from_time: Values | None = None,
    to_time: Values | None = None,
    rows: Values | None = None,
    missing: Literal['refuse', 'drop', 'split', 'fill'] | None = None,
    estimator: Literal['adaptive', 'didim', 'ekf', 'gls', 'irls', 'iv', 'ls', 'ml', 'rls', 'separable', 'tls', 'wls'] | None = None,
    set: Settings | None = None,
    forgetting: Values | None = None,
    p0: Values | None = None,
    initial: TableLike | None = None,
    skip: Values | None = None,
    decimate: Values | None = None,
    drop_slow: Values | None = None,
    all_rows: bool | None = None,
    bandwidth: Values | None = None,
    smooth_sign: Values | None = None,
    align: bool | None = None,
    from_: TableLike | None = None,
    essential: bool | None = None,
    friction: Literal['described', 'auto'] | None = None,
    consistent: bool | None = None,
    gains: TableLike | None = None,
    free_gains: Values | None = None,
    torque_gain_error: Values | None = None,
    variance: Literal['residual', 'unit', 'sample'] | None = None,
    require: Literal['good', 'rough', 'not-biased', 'identifiable'] | None = None,
    trace: Values | None = None,
    save: Values | None = None,
    no_history: bool | None = None,
) -> Judged:
    """Estimate a robot's dynamic parameters from a motion, and judge their reliability.

      scarid identify --robot arm.toml log.csv
      scarid differentiate log.csv --format arrow | scarid identify --robot arm.toml
      scarid identify --estimator wls --drop-slow 0.1 --align motion.csv
      scarid identify --estimator ls --robot emps --skip 49 --decimate 10 motion.parquet
      scarid identify --forgetting 0.999,Fv1=0.99 --trace trace.parquet motion.csv
      scarid identify --robot arm.toml monday.parquet tuesday.parquet
      scarid identify --save state.npz monday.csv; scarid identify --from state.npz tuesday.csv

    A measurement, which has positions and torques but no derivatives, is identified by the whole
    recommended procedure in one process: the bandwidth is chosen as by `scarid tune --robot`,
    positions and torques of all joints pass a smoother of this bandwidth, and the parameters are
    estimated with --estimator gls --align. The pipe of two commands that gives the same parameters
    is reported. The measurement is held in memory.

    Several logs are segments of one estimation: all have the same robot, units and rate, nothing
    is filtered from one to the next, and a measurement gets one bandwidth and one delay for all.
    --from-time, --to-time and --rows apply to each of them.

    Solves tau = W(q, dq, ddq) theta (paper eq. 25), where W is the robot's regressor. Each estimate
    has two standard errors: one that holds for white residuals, s (diag (W'W)^-1)^1/2 (eq. 32-34),
    and a robust one, which also holds for autocorrelated residuals and allows for what the model
    may lack: it grows where the estimates would change with an offset or Stribeck friction, without
    the rows near reversals, or behind another low-pass. The columns low and high are the 95 %
    confidence interval from the robust error. The verdict (good, doubtful or not identifiable) and
    its reasons are on standard error, and in the metadata of the table.

    Options:
        robot: The robot: scara2, emps, planar2-gravity, or a .toml or .urdf file. [default: the robot named in the table's metadata, else $SCARID_ROBOT, else scara2]
        from_time: Read the log from this time on [s].
        to_time: Read the log up to this time [s].
        rows: Read rows A to B only, counted from 1.
        missing: What to do where a value is missing: refuse the log; drop the row; split, which also begins a new segment after it, as after a gap; or fill, for sources that write in turn: keep the rows with q1, and interpolate the other columns there (holds the log in memory).
        estimator: The estimator; see below. [default: rls; gls for a measurement, unless --trace, --save, --from, --set, --initial or --forgetting is given]
        set: A setting of the estimator; repeatable.
        forgetting: Forgetting factor of rls per sample, followed by other factors for single parameters. [default: 1]
        p0: Initial covariance of rls, P0 = p0 I. [default: 100]
        initial: Initial parameters of rls or ekf: a parameter table, or `apriori` for the a priori values of the robot. [default: zeros]
        skip: Leave out this many rows at the start and, if there are two numbers, at the end.
        decimate: Pass the columns of W and the torques through the same low-pass and keep every N-th row; repeat this for each N. Holds the whole log in memory.
        drop_slow: Leave out the rows of a joint that is slower than V [rad/s or m/s], one value for all joints or one per joint, because near rest Coulomb friction is not sign(dq).
        all_rows: Use the rows near reversals and near standstill as well. By default rows are left out where a joint reverses within half a period of the motion's bandwidth, or is slower than 2 % of its root-mean-square velocity so far or than its noise.
        bandwidth: Bandwidth of the motion. [default: that in the metadata, which differentiate --match writes and CSV cannot hold]
        smooth_sign: Model Coulomb friction by tanh(dq / V) instead of sign(dq) [rad/s or m/s].
        align: Also fit the time by which the torques lead the motion. Holds the whole log in memory. [default: --align for a measurement only]
        from_: Continue the estimation that --save wrote.
        essential: Keep only essential parameters: drop one after another, the least certain first, while its relative standard deviation is more than 30 times the smallest one and the fit gets no worse than noise explains.
        friction: With auto, also fit friction that the robot has no term for, as far as it lowers the error of parts of the log that are left out of the fit: asymmetric, falling or curved with the speed, growing with the load, rippling with the position.
        consistent: Estimates that rigid bodies can have: those nearest to the free ones, in units of their errors, with positive masses and inertias, and with friction and motor inertias that are not negative. Intervals keep to that as well. Needs a URDF, and cvxpy (extra `urdf`).
        gains: Divide the torques by the gains that `scarid gains` wrote.
        free_gains: Estimate the gain of each joint's torque as well, and divide the torques by them. ANCHOR fixes the factor that all have in common: the number of a joint, whose gain is 1; `masses`, those of the URDF; or `constants`, within --torque-gain-error.
        torque_gain_error: Standard error of the torque constants, such as 1% or 0.01. No log shows the factor that all have in common. It is added to the errors of the parameters; with --free-gains, it is what is known of each gain before the log. [default: 0]
        variance: Variance of the residual in the column standard_error: estimated with r - c degrees of freedom (residual), 1 as printed in paper eq. 32-33 (unit), or estimated with r - 1 (sample).
        require: Exit with status 3 if the verdict is worse; the table is written all the same. A doubtful verdict is not-biased unless the soft sensor or a delay changes the estimates, or the log fails a check.
        trace: Write the estimates after every sample (rls, ekf).
        save: Write the state of the estimation (.npz), to be continued with --from.
        no_history: Write no history into the metadata.
    """

def validate(
    *tables: TableLike,
    parameters: TableLike | None = None,
    robot: TableLike | None = None,
    from_time: Values | None = None,
    to_time: Values | None = None,
    rows: Values | None = None,
    missing: Literal['refuse', 'drop', 'split', 'fill'] | None = None,
    skip: Values | None = None,
    decimate: Values | None = None,
    drop_slow: Values | None = None,
    all_rows: bool | None = None,
    bandwidth: Values | None = None,
    smooth_sign: Values | None = None,
    require: Literal['unchanged'] | None = None,
    rollout: Values | None = None,
    predictions: Values | None = None,
    residual: Values | None = None,
    false_alarms: Values | None = None,
    observer: Values | None = None,
    no_history: bool | None = None,
) -> Judged:
    """Measure how well identified parameters predict the torques of a log.

      scarid validate --parameters parameters.parquet log.csv
      scarid validate --parameters p.parquet --predictions torques.parquet motion.parquet
      scarid validate --parameters may.parquet --parameters june.parquet july.csv
      scarid validate --parameters p.parquet --residual - -o metrics.csv motion.parquet

    The velocities and accelerations of a measurement (a log that has none) are estimated with the
    bandwidth of the identification, as far as the parameters state it, and the pipe that gives the
    same result is reported; this holds the log in memory. A motion is taken as it is.

    Writes for each joint R2 (paper eq. 36), the root-mean-square error (eq. 35), the relative error
    100 |tau - tau_hat| / |tau| in percent, and the number of samples. On the motion that the
    parameters were identified from, this is direct validation; on another motion, it is cross
    validation. Several logs count as one. Give the options that select and treat rows as they
    were given to identify. Several parameter tables are pooled, weighted by the information of
    their logs: the new log is then compared with all of these logs together.

    The verdict, on standard error and in the metadata, says whether the robot has changed since the
    identification: `unchanged`, `changed` with the cause (another payload or set-up, the friction,
    the motor constant or the offset of a joint, another delay, reversed or swapped joints), or
    `unexplained`. Of an unchanged robot that moves alike, at most one comparison in a hundred has
    another verdict by chance; on another kind of motion more may, as no model is exact. A change of
    the torques within the intervals that the identification states, and within 10 %, is named, but
    counts as `unchanged`. Parameters in a CSV file lack what
    the tests of delay and offsets need: write them as Parquet or Arrow.

    The band of --residual has two parts, whose squares add up: half the 95 % interval of the
    predicted torque at that row, and the level that the largest residuals of the identification's
    log, half a second each, pass as rarely as --false-alarms says. Rows that are left out, as near
    a reversal, are not judged. In a pipe, rows are written as they arrive.

    Options:
        parameters: The parameter table that `scarid identify` wrote, or `apriori` for the a priori values (CAD) of the robot's description; repeatable: several are pooled.
        robot: The robot: scara2, emps, planar2-gravity, or a .toml or .urdf file. [default: the robot named in the table's metadata, else $SCARID_ROBOT, else scara2]
        from_time: Read the log from this time on [s].
        to_time: Read the log up to this time [s].
        rows: Read rows A to B only, counted from 1.
        missing: What to do where a value is missing: refuse the log; drop the row; split, which also begins a new segment after it, as after a gap; or fill, for sources that write in turn: keep the rows with q1, and interpolate the other columns there (holds the log in memory).
        skip: Leave out this many rows at the start and, if there are two numbers, at the end.
        decimate: Pass the columns of W and the torques through the same low-pass and keep every N-th row; repeat this for each N. Holds the whole log in memory.
        drop_slow: Leave out the rows of a joint that is slower than V [rad/s or m/s], one value for all joints or one per joint, because near rest Coulomb friction is not sign(dq).
        all_rows: Use the rows near reversals and near standstill as well. By default rows are left out where a joint reverses within half a period of the motion's bandwidth, or is slower than 2 % of its root-mean-square velocity so far or than its noise.
        bandwidth: Bandwidth of the motion. [default: that in the metadata, which differentiate --match writes and CSV cannot hold]
        smooth_sign: Model Coulomb friction by tanh(dq / V) instead of sign(dq) [rad/s or m/s].
        require: Exit with status 3 if the verdict is another one, or if there is none; the table is written all the same.
        rollout: Also simulate: from measured states, the model moves by the measured torques for so long, and its positions are compared with the measured ones.
        predictions: Write the measured and the predicted torques.
        residual: Write the residual torque of each row, the band that it stays in, and the joint that is beyond it: a contact.
        false_alarms: How often in an hour of motion --residual may call a contact by chance. [default: 1]
        observer: Let --residual take the residual of a momentum observer of this bandwidth, which needs no accelerations. [default: that of the torques]
        no_history: Write no history into the metadata.
    """

def compare(
    *tables: TableLike,
    require: Literal['same'] | None = None,
    no_history: bool | None = None,
) -> Judged:
    """Compare identifications: which parameters differ by more than their errors allow.

      scarid compare before.parquet after.parquet
      scarid compare january.parquet february.parquet march.parquet -o drift.csv

    The tables are those of `scarid identify`, for one robot. Every table is compared with the
    first one: for each parameter the difference, its standard error, the number of errors, and a
    p-value from Student's t. The p-values are corrected by Holm's method, so that at most one
    comparison in twenty reports a difference where there is none. If the tables carry covariances
    (Parquet and Arrow), all parameters are also tested together (Hotelling's F test), which finds
    differences that no single parameter shows. From three tables on, the trend is tested as well.

    The verdict goes to standard error and into the metadata. To find out what has changed, give a
    log to `scarid validate`.

    Options:
        require: Exit with status 3 if a table differs from the first one; the table of differences is written all the same.
        no_history: Write no history into the metadata.
    """

def payload(
    *tables: TableLike,
    parameters: TableLike | None = None,
    robot: TableLike | None = None,
    frame: Values | None = None,
    trace: Values | None = None,
    false_alarms: Values | None = None,
    from_time: Values | None = None,
    to_time: Values | None = None,
    rows: Values | None = None,
    no_history: bool | None = None,
) -> Log:
    """Find what hangs on the flange: mass, centre and inertia, each with its 95 % interval.

      scarid payload --parameters bare.parquet loaded.csv
      scarid payload --parameters bare.parquet --frame tool loaded.parquet -o payload.csv
      scarid payload --parameters bare.parquet --trace trace.csv loaded.parquet

    LOADED are logs of the robot with the payload, as recorded, or the table of parameters that
    `scarid identify` wrote for them. The bare robot is identified beforehand, best from the same
    motion. The payload is the difference of the two identifications, as a part of the last link:
    friction and offsets may differ, and errors that both have in common drop out. The intervals
    contain the uncertainty of both. A value that the motion does not tell has no error, and is
    named. Where no body can have these values, the nearest one that can is given beside them. The
    settings for controllers of UR, Franka and KUKA are printed as these take them. The robot needs
    a URDF (pip install 'scarid[urdf]').

    Options:
        parameters: The parameters of the bare robot, as `scarid identify -o bare.parquet` writes them.
        robot: The robot: scara2, emps, planar2-gravity, or a .toml or .urdf file. [default: the robot named in the table's metadata, else $SCARID_ROBOT, else scara2]
        frame: The link of the URDF in whose frame the payload is stated. [default: the tool]
        trace: Say when a payload is picked up or put down, as rows arrive, and write the present one after each quarter of a second to FILE. The table has a row for each payload.
        false_alarms: Of --trace: how many changes may be told by chance alone [1/h]. [default: 1]
        from_time: Read the log from this time on [s].
        to_time: Read the log up to this time [s].
        rows: Read rows A to B only, counted from 1.
        no_history: Write no history into the metadata.
    """

def gains(
    *tables: TableLike,
    parameters: TableLike | None = None,
    mass: Values | None = None,
    centre: Values | None = None,
    frame: Values | None = None,
    robot: TableLike | None = None,
    from_time: Values | None = None,
    to_time: Values | None = None,
    rows: Values | None = None,
    toml: Values | None = None,
    no_history: bool | None = None,
) -> Log:
    """Find the gain of each joint's torque, and so its torque constant, from a known load.

      scarid gains --parameters bare.parquet --mass 2 loaded.csv
      scarid gains --parameters bare.parquet --mass 2+-0.01 loaded.parquet -o gains.csv
      scarid gains --parameters bare.parquet --mass 2 --centre 0,0,0.1+-0.002 loaded.csv

    The gain of a joint is its logged torque, divided by the true one. LOADED are logs of the robot
    with a load whose mass is known, as recorded, or the table of parameters that `scarid identify`
    wrote for them. The bare robot is identified beforehand, best from the same motion. Joints share
    parameters, so that each log tells the gains relative to each other; the weight of the load
    tells the factor that they have in common. Friction and offsets may differ from log to log.
    A gain that the motion does not tell within 10 % is empty, and is named. `scarid identify
    --gains` takes the table, and divides the torques by these gains. The robot needs a URDF (pip
    install 'scarid[urdf]').

    Options:
        parameters: The parameters of the bare robot, as `scarid identify -o bare.parquet` writes them.
        mass: The mass of the load [kg], and half its 95 % interval.
        centre: Its centre [m] in the frame of --frame, and half the 95 % interval of each.
        frame: The link of the URDF in whose frame --centre is stated. [default: the tool]
        robot: The robot: scara2, emps, planar2-gravity, or a .toml or .urdf file. [default: the robot named in the table's metadata, else $SCARID_ROBOT, else scara2]
        from_time: Read the log from this time on [s].
        to_time: Read the log up to this time [s].
        rows: Read rows A to B only, counted from 1.
        toml: Write the torque constants that are then right, as lines of the TOML file of a robot whose logs have currents.
        no_history: Write no history into the metadata.
    """

def report(
    *tables: TableLike,
    output: Values | None = None,
    html: Values | None = None,
    markdown: Values | None = None,
    published: TableLike | None = None,
    repeated: bool | None = None,
    fleet: Values | None = None,
    figures: Values | None = None,
    title: Values | None = None,
) -> Text:
    """Print tables and draw figures of logs, motions, parameters, traces, metrics and predictions.

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

    Options:
        output: Write the printed tables to FILE. [default: standard output]
        html: Write one self-contained page with tables and figures.
        markdown: Write the tables as Markdown.
        published: A table of published values to print beside the results.
        repeated: Files of the same name in different folders are repetitions of one experiment: print medians and quartiles.
        fleet: Report the outcome of a batch, which is in FOLDER, in place of FILEs: one row per log.
        figures: Write each figure as an SVG file.
        title: Title of the documents. [default: Identification of ROBOT, with --fleet Fleet report]
    """

def urdf(
    *tables: TableLike,
    parameters: TableLike | None = None,
    robot: TableLike | None = None,
    output: Values | None = None,
    base: Values | None = None,
    motion: TableLike | None = None,
    skip: Values | None = None,
    decimate: Values | None = None,
    drop_slow: Values | None = None,
    all_rows: bool | None = None,
    bandwidth: Values | None = None,
    smooth_sign: Values | None = None,
) -> Text:
    """Write identified parameters into a copy of a URDF as physically consistent link inertias.

      scarid urdf --parameters parameters.parquet arm.urdf -o identified.urdf
      scarid urdf --parameters p.parquet --motion motion.parquet arm.toml -o identified.urdf
      scarid urdf --parameters p.parquet --base near.csv arm.toml -o identified.urdf

    ROBOT is the URDF, or the TOML file that names it, as with --robot. Identified base parameters
    may belong to no real robot: a mass may come out negative, for example. This command computes
    physically consistent link inertias from them: positive masses and positive definite
    pseudo-inertias (Wensing, Kim, Slotine 2018), at the smallest Mahalanobis distance from the
    estimates. Of all such bodies it takes those closest to the bodies of the URDF. Parameters that
    `identify --essential` dropped stay at zero where positive masses allow it.

    The covariance of the estimates comes with a Parquet or Arrow table. CSV has none; the
    correlations are then neglected, which can ruin the prediction of torques: check with --motion.

    Viscous and Coulomb friction become damping and friction of the joints. What a URDF cannot hold
    (motor inertias, offsets, couplings) is written into a comment. This command needs an extra:
    pip install 'scarid[urdf]'.

    Options:
        parameters: The parameter table of `scarid identify --robot ROBOT`; in Parquet or Arrow it carries the covariance of the estimates.
        robot: The robot: scara2, emps, planar2-gravity, or a .toml or .urdf file. [default: the robot named in the table's metadata, else $SCARID_ROBOT, else scara2]
        output: Write the URDF to FILE. [default: standard output]
        base: Write the base parameters of the new bodies as a table.
        motion: Report R2 per joint on this motion, of the identified and of the consistent parameters. Give the options below as they were given to identify.
        skip: Leave out this many rows at the start and, if there are two numbers, at the end.
        decimate: Pass the columns of W and the torques through the same low-pass and keep every N-th row; repeat this for each N. Holds the whole log in memory.
        drop_slow: Leave out the rows of a joint that is slower than V [rad/s or m/s], one value for all joints or one per joint, because near rest Coulomb friction is not sign(dq).
        all_rows: Use the rows near reversals and near standstill as well. By default rows are left out where a joint reverses within half a period of the motion's bandwidth, or is slower than 2 % of its root-mean-square velocity so far or than its noise.
        bandwidth: Bandwidth of the motion. [default: that in the metadata, which differentiate --match writes and CSV cannot hold]
        smooth_sign: Model Coulomb friction by tanh(dq / V) instead of sign(dq) [rad/s or m/s].
    """

def export(
    *tables: TableLike,
    parameters: TableLike | None = None,
    robot: TableLike | None = None,
    to: Literal['urdf', 'mjcf', 'toml', 'json', 'c', 'matlab'] | None = None,
    name: Values | None = None,
    output: Values | None = None,
    base: Values | None = None,
) -> Text:
    """Write identified dynamics for controllers and simulators: C, MATLAB, MJCF, URDF, TOML, JSON.

      scarid export --parameters p.parquet --name arm -o arm.h
      scarid export --to matlab --parameters p.parquet --name arm -o arm.m
      scarid export --to mjcf --parameters p.parquet arm.toml -o arm.xml
      scarid export --to toml --parameters p.parquet arm.toml -o identified.toml
      scarid export --to json --parameters p.parquet arm.toml > identified.json

    ROBOT is the robot of the parameters, as with --robot. Each file has the 95 % interval of every
    parameter.

    c       a C99 header without dependencies, for a controller: gravity,
            inverse dynamics, mass matrix and friction, with the numbers in
            one structure
    matlab  the same as a class with static functions: tau = arm.gravity(q)
    toml    the description with a table [estimates], which every command
            reads: `simulate --robot` then moves the identified robot
    urdf    the file of `scarid urdf`: possible bodies, friction, motors
    mjcf    the same bodies for MuJoCo, with armature, damping, frictionloss,
            gears and offsets; needs pip install 'scarid[sim,urdf]'
    json    parameters, bodies and drives of each link and axis, by a schema

    The torques of c, matlab and toml are those that `scarid validate` predicts, without the delay
    and without what identify fitted beside the parameters. Bodies that are physically possible have
    slightly other ones: those that it predicts with the table of --base.

    Options:
        parameters: The parameter table of `scarid identify`; in Parquet or Arrow it carries the covariance of the estimates, which urdf, mjcf and json need.
        robot: The robot: scara2, emps, planar2-gravity, or a .toml or .urdf file. [default: the robot named in the table's metadata, else $SCARID_ROBOT, else scara2]
        to: What to write (see above).
        name: What the names of the functions in C begin with; the name of the class in MATLAB.
        output: Write to FILE. [default: standard output]
        base: Of urdf, mjcf and json: write the base parameters of the new bodies as a table, which `scarid validate` takes.
    """

def convert(
    *tables: TableLike,
    from_: Literal['ur-rtde', 'aurt', 'libfranka', 'plotjuggler', 'lerobot', 'unitree'] | None = None,
    map: Settings | None = None,
    unit: Settings | None = None,
    rate: Values | None = None,
    joints: Values | None = None,
    robot: TableLike | None = None,
    unwrap: bool | None = None,
    despike: bool | None = None,
    beside: TableLike | None = None,
    topic: Values | None = None,
    torque_topic: Values | None = None,
    join: Literal['linear', 'hold'] | None = None,
    separator: Values | None = None,
    decimal_comma: bool | None = None,
    header: Values | None = None,
    from_time: Values | None = None,
    to_time: Values | None = None,
    rows: Values | None = None,
    no_history: bool | None = None,
) -> Log:
    """Convert between table formats, or turn a recorded log into a table.

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

    Options:
        from_: Whose column names the log has. [default: found from them]
        map: Rename columns to what the commands expect: q1, tau1, t, ...; 'q*=name' renames name1, name2, ... to q1, q2, ...; repeatable.
        unit: The unit of columns in the log (deg, rpm, mN m, ms, ...), which are converted to rad, N m, s; * and ? match any name; repeatable.
        rate: Add a time column t at this rate [Hz].
        joints: The names of the joints, in order, where the log has names. [default: those of --robot]
        robot: The robot of the log: joints in the order of its axes, and what its description says of its logs (columns, units, motors).
        unwrap: Add the turns that positions and torques lack: of angles that wrap, and of counters.
        despike: Put nan for single positions and torques that leap away and return; `scarid resample --missing drop` interpolates them.
        beside: Another log with the same rows, whose columns are added; as tau=FILE they are called tau1, tau2, ... (or q, dq, current, q_ref); repeatable.
        topic: The topic of a ROS recording. [default: the only one with positions of joints]
        torque_topic: Another topic, whose efforts are joined to the rows.
        join: How these efforts are brought to the times of the rows: interpolated, or the last one.
        separator: The separator of values, such as ; or \\t, or a space for any white space. [default: found from the first lines]
        decimal_comma: The CSV has decimal commas.
        header: The column names of a log without a header.
        from_time: Read the log from this time on [s].
        to_time: Read the log up to this time [s].
        rows: Read rows A to B only, counted from 1.
        no_history: Write no history into the metadata.
    """

def info(
    *tables: TableLike,
    robot: TableLike | None = None,
    from_time: Values | None = None,
    to_time: Values | None = None,
    rows: Values | None = None,
) -> Text:
    """Describe a table: kind, columns with units and extremes, sampling, metadata and history.

      scarid info log.parquet
      scarid info recording.mcap
      scarid trajgen --format arrow | scarid info
      scarid info --json log.parquet | jq '.columns[] | select(.missing > 0) | .name'

    Reads the whole table, in bounded memory. The kind of a CSV is inferred from its columns. Each
    column is shown with its least and greatest value and the number of missing ones. Of a ROS
    recording (MCAP, rosbag2, ROS 1) it lists the topics, with types, counts and rates.

    Options:
        robot: A .toml file of the robot, whose [log] says what the columns are, if they have other names than ours. [default: $SCARID_ROBOT]
        from_time: Read the log from this time on [s].
        to_time: Read the log up to this time [s].
        rows: Read rows A to B only, counted from 1.
    """
