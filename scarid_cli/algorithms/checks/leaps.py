"""Angles and counters that wrap, and single readings that leap away and return."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import pi

import numpy as np

from scarid_cli.algorithms.checks.finding import Finding, failed, ok, several, warning
from scarid_cli.algorithms.checks.log import Log
from scarid_cli.algorithms.processes.leaps import Leaps, leaps_of
from scarid_cli.arrays import Array

NAMES = {2.0 * pi: "2 pi", pi: "pi"}  # of moduli; others are told as numbers
FEW = 3  # rows and columns that are listed

Found = dict[str, Leaps]


def found_in(log: Log) -> Found:
    """The leaps of positions and torques, by column."""
    pairs = zip(log.names, log.signals, strict=True)
    every = {name: leaps_of(x) for name, x in pairs}
    return {name: leaps for name, leaps in every.items() if len(leaps.wraps) + len(leaps.glitches)}


def mended(log: Log, found: Found) -> Log:
    """The log without its wraps, and with nan for its glitches."""
    if not found:
        return log
    signals = [
        _mended(x, found[name]) if name in found else x
        for name, x in zip(log.names, log.signals, strict=True)
    ]
    return replace(log, q=np.array(signals[: log.joints]), tau=np.array(signals[log.joints :]))


def _mended(x: Array, leaps: Leaps) -> Array:
    return leaps.without_glitches(leaps.unwrapped(x))


def wraps(found: Found) -> Finding:
    """Signals that go back by a turn or by the range of a counter."""
    own = {name: leaps for name, leaps in found.items() if len(leaps.wraps)}
    if not own:
        return ok("wraps", "none")
    texts = [
        f"{name} leaps by {_size(leaps.modulus)} in {several(len(leaps.wraps), 'row')}, first in "
        f"row {leaps.wraps[0] + 1}"
        for name, leaps in own.items()
    ]
    figure = "; ".join(texts[:FEW]) + _more(len(texts))
    return failed("wraps", figure, "an angle or a counter that wraps: `scarid convert --unwrap`")


def glitches(found: Found, jumps: Mapping[str, str], resampling: str) -> Finding:
    """Readings far from those beside them, and jumps with what to do about each (jumps.told).

    `resampling` interpolates single readings once they are empty.
    """
    own = {name: leaps for name, leaps in found.items() if len(leaps.glitches)}
    if jumps:
        return failed("glitches", "; ".join(jumps), "; ".join(dict.fromkeys(jumps.values())))
    if not own:
        return ok("glitches", "none")
    texts = [
        f"{name} leaps away and returns in {several(len(leaps.glitches), 'row')} ("
        + ", ".join(str(row + 1) for row in leaps.glitches[:FEW])
        + (", ...)" if len(leaps.glitches) > FEW else ")")
        for name, leaps in own.items()
    ]
    figure = "; ".join(texts[:FEW]) + _more(len(texts))
    advice = f"`scarid convert --despike` empties these cells, and {resampling} interpolates"
    status = failed if any(name.startswith("q") for name in own) else warning
    return status("glitches", figure, advice)


def _more(count: int) -> str:
    return f"; and {several(count - FEW, 'further column')}" if count > FEW else ""


def _size(modulus: float) -> str:
    return NAMES.get(modulus, f"{modulus:.6g}")
