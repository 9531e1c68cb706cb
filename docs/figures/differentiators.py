"""What soft sensors do to an acceleration: gain and delay by frequency, and the step.

scarid tune --robot scara2 --method METHOD samples/scara2.csv -o trials.parquet
scarid differentiate --method METHOD SETTINGS --no-match sines.csv -o METHOD.parquet

Each method has the same bandwidth, which `tune` chose for the sample log. Each joint of sines.csv
moves with another frequency, and the last one begins to accelerate at 1 rad/s2.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pyarrow.parquet as pq
from figures import common
from figures.common import INK, PALETTE, Array, Data, rounded
from matplotlib.figure import Figure

METHODS = ("kalman", "high-gain", "p2smd", "ed-fir", "rts")
PERIOD, ROWS = 0.01, 4000
FREQUENCIES = np.geomspace(0.2, 40.0, 24)
START = 20.0  # s: the last joint begins to move
SHOWN = (-0.1, 0.4)  # s about it


def data(methods: Sequence[str] = METHODS) -> Data:
    """Of each method: gain, delay [ms] of the acceleration, and its answer to a step."""
    t = np.arange(ROWS) * PERIOD
    speeds = 2.0 * np.pi * FREQUENCIES[:, None]
    steps = 0.5 * np.maximum(t - START, 0.0) ** 2
    q = np.vstack([np.sin(speeds * t) / speeds, steps])
    header = ",".join(["t", *(f"q{i}" for i in range(1, len(q) + 1))])
    wanted = [f"ddq{i}" for i in range(1, len(q) + 1)]
    found: Data = {"frequencies": rounded(FREQUENCIES)}
    tune, differentiate = __doc__.strip().split("\n")[2:4]
    with common.shell() as run:
        np.savetxt("sines.csv", np.vstack([t, q]).T, "%.12g", ",", header=header, comments="")
        for method in methods:
            run(tune.replace("METHOD", method))
            settings = " ".join(f"--set {word}" for word in _settings(method))
            run(differentiate.replace("METHOD", method).replace("SETTINGS", settings))
            time, *motion = common.columns(f"{method}.parquet", "t", *wanted)
            found[method] = _answer(time, np.array(motion))
    return found


def part() -> Data:
    """One method, which a test compares."""
    return data(("kalman",))


def _settings(method: str) -> list[str]:
    """What `tune` chose for all joints alike, as NAME=VALUE."""
    rows = pq.read_table("trials.parquet").to_pylist()
    (found,) = (r["settings"] for r in rows if r["method"] == method and r["best"])
    return list(found.split())


def _answer(t: Array, motion: Array) -> Data:
    settled = (t > 8.0) & (t < 32.0)
    ratios = [
        _amplitude(t[settled], x[settled], f) / (1j * 2.0 * np.pi * f)
        for f, x in zip(FREQUENCIES, motion[:-1], strict=True)
    ]
    phase = np.unwrap(np.angle(ratios))
    delay = -1e3 * phase / (2.0 * np.pi * FREQUENCIES)
    near = (t > START + SHOWN[0]) & (t < START + SHOWN[1])
    return {
        "gain": rounded(np.abs(ratios)),
        "delay": rounded(np.round(delay, 3)),
        "step": [rounded(np.round(t[near] - START, 6)), rounded(np.round(motion[-1][near], 5))],
    }


def _amplitude(t: Array, x: Array, frequency: float) -> complex:
    """The complex amplitude of this frequency, relative to that of a velocity sin / w -> cos."""
    angle = 2.0 * np.pi * frequency * t
    basis = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    (cosine, sine), *_ = np.linalg.lstsq(basis, x, rcond=None)
    return complex(cosine, -sine)


def drawn(found: Data) -> Figure:
    """Gain, delay and step beside the ideal."""
    figure, (gain, delay, step) = common.panels(1, 3, 2.6)
    frequencies = found["frequencies"]
    ideal = {"color": INK, "linestyle": "--", "linewidth": 0.8}
    for k, method in enumerate(METHODS):
        one, how = found[method], {"color": PALETTE[k], "label": method}
        gain.loglog(frequencies, one["gain"], **how)
        known = [i for i, x in enumerate(one["gain"]) if x > 0.05]  # below, a phase means nothing
        delay.semilogx([frequencies[i] for i in known], [one["delay"][i] for i in known], **how)
        step.plot(*one["step"], **how)
    gain.axhline(1.0, **ideal)
    gain.set(ylim=(0.01, 2.0), xlabel="frequency [Hz]")
    delay.axhline(0.0, **ideal)
    delay.set_xlabel("frequency [Hz]")
    step.plot([SHOWN[0], 0.0, 0.0, SHOWN[1]], [0.0, 0.0, 1.0, 1.0], **ideal)
    step.set_xlabel("t [s]")
    handles, names = gain.get_legend_handles_labels()
    for axes, title in ((gain, "gain / ideal"), (delay, "delay [ms]"), (step, "step [rad/s2]")):
        common.plain_powers(axes)
        axes.set_title(title, loc="left", fontsize=8.5, fontweight="bold")
    figure.legend(handles, names, loc="outside upper center", ncols=len(names))
    return figure
