"""What phase matching leaves of the phase for the sliding-mode methods: a table in docs/theory.md.

A sine of 20 s is sampled at 200 Hz by an encoder of 16 bit. Its true acceleration passes the torque
filter of the method, as a torque that is proportional to it would. The table shows by how many
degrees the matched acceleration lags behind that, at the frequency of the sine, over the last five
seconds. `-` stands for an acceleration that is not the motion's: its first harmonic explains less
than half of its variance, or is less than half as large as the true one.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from signals import H, seen

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.algorithms.filters.sliding import SlidingMode
from scarid_cli.algorithms.processes.matching import over

SECONDS, LAST = 20.0, 5.0
FREQUENCIES = (0.25, 0.5, 1.0, 2.0)  # [Hz]
AMPLITUDES = (0.1, 0.5, 1.0)  # [rad]


def methods() -> Iterator[tuple[str, Any]]:
    """The sliding-mode methods, as they come and with their presets."""
    for name in DIFFERENTIATORS.names:
        method = DIFFERENTIATORS.load(name)
        if issubclass(method, SlidingMode):
            yield name, method()
            for preset, settings in method.PRESETS.items():
                yield f"{name} {preset}", method(**settings)


def misphase(method: Any, frequency: float, amplitude: float) -> float:
    """The lag [degrees] of the matched acceleration behind the matched torque, or nan."""
    t = np.arange(round(SECONDS / H)) * H
    w = 2.0 * np.pi * frequency
    q, force = amplitude * np.sin(w * t), -amplitude * w**2 * np.sin(w * t)
    matched = method.matched()
    (torque,) = over(matched.torque_filter, force, H)
    a = over(matched, seen(q, 16, 1), H)[2]
    last = slice(-round(LAST / H), None)
    turn = np.exp(-1j * w * t[last])
    ours, true = (2.0 * np.mean(x[last] * turn) for x in (a, torque))
    power = np.mean(a[last] ** 2)
    if 0.5 * abs(ours) ** 2 < 0.5 * power or abs(ours) < 0.5 * abs(true):
        return float("nan")
    return float(np.degrees(np.angle(true / ours)))


def main() -> None:
    columns = [(f, a) for f in FREQUENCIES for a in AMPLITUDES]
    print(f"{'':18}" + "".join(f"{f:g} Hz".center(18) for f in FREQUENCIES))
    print(f"{'amplitude [rad]':18}" + "".join(f"{a:6g}" for _, a in columns))
    for name, method in methods():
        with np.errstate(all="ignore"):
            found = [misphase(method, *column) for column in columns]
        print(f"{name:18}" + "".join(f"{x:6.1f}" if x == x else "     -" for x in found))


if __name__ == "__main__":
    main()
