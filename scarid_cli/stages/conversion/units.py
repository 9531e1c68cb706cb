"""The units that a log may have, and those that names of columns state."""

from __future__ import annotations

import re
from collections.abc import Iterable
from fnmatch import fnmatchcase
from math import inf, pi

POUND, INCH = 4.4482216152605, 0.0254  # N and m, by definition (NIST SP 811)
KILOPOND = 9.80665  # N
# For each unit that a log may have: the factor to multiply by, and the resulting unit.
UNITS = {
    "deg": (pi / 180.0, "rad"),
    "deg/s": (pi / 180.0, "rad/s"),
    "deg/s2": (pi / 180.0, "rad/s2"),
    "rev": (2.0 * pi, "rad"),
    "rpm": (2.0 * pi / 60.0, "rad/s"),
    "mm": (1e-3, "m"),
    "mm/s": (1e-3, "m/s"),
    "mN m": (1e-3, "N m"),
    "N mm": (1e-3, "N m"),
    "N cm": (1e-2, "N m"),
    "kN m": (1e3, "N m"),
    "kgf m": (KILOPOND, "N m"),
    "kgf cm": (KILOPOND * 1e-2, "N m"),
    "lbf ft": (POUND * 12.0 * INCH, "N m"),
    "lbf in": (POUND * INCH, "N m"),
    "ozf in": (POUND * INCH / 16.0, "N m"),
    "mN": (1e-3, "N"),
    "kN": (1e3, "N"),
    "kgf": (KILOPOND, "N"),
    "lbf": (POUND, "N"),
    "mA": (1e-3, "A"),
    "ms": (1e-3, "s"),
    "us": (1e-6, "s"),
    "ns": (1e-9, "s"),
}
ALIASES = {
    "°": "deg", "degree": "deg", "degrees": "deg", "Grad": "deg", "turn": "rev", "turns": "rev",
    "sec": "s", "seconds": "s", "µs": "us", "msec": "ms", "usec": "us", "nsec": "ns",
    "1/min": "rpm", "rad/s^2": "rad/s2", "deg/s^2": "deg/s2", "m/s^2": "m/s2",
    "Nm": "N m", "mNm": "mN m", "kNm": "kN m", "Nmm": "N mm", "Ncm": "N cm",
    "kgfm": "kgf m", "kg m": "kgf m", "kgfcm": "kgf cm", "kgcm": "kgf cm", "kg cm": "kgf cm",
    "ft lb": "lbf ft", "lb ft": "lbf ft", "ft lbf": "lbf ft", "ftlb": "lbf ft", "lbft": "lbf ft",
    "lbfft": "lbf ft", "ftlbf": "lbf ft", "in lb": "lbf in", "lb in": "lbf in", "in lbf": "lbf in",
    "inlb": "lbf in", "lbin": "lbf in", "lbfin": "lbf in", "inlbf": "lbf in",
    "oz in": "ozf in", "in oz": "ozf in", "ozin": "ozf in", "ozfin": "ozf in",
}  # fmt: skip
KNOWN = {**{unit: unit for unit in UNITS}, **{si: si for _, si in UNITS.values()}, **ALIASES}
BETWEEN = re.compile(r"[\s*\u00b7\u22c5.-]+")  # what stands between the parts of a product
# Units that only their device knows.
UNSTATED = re.compile(
    r".*(?:[\[(]|[_ ](?=\S*\Z))\s*"
    r"(incs?|increments?|counts?|cnt|ticks?|pulses?|[^\])_ ]*%|\u2030|pct|percent|permille|LSB"
    r"|p\.?u\.?)"
    r"\s*[\])]?\s*",
    re.IGNORECASE,
)
STRANGE = re.compile(r".+[\s_]\[([^\]\d]{1,6})\]\s*")  # a text where others have their unit
SI = {"t": "s", "q": "rad", "dq": "rad/s", "ddq": "rad/s2", "tau": "N m", "current": "A"}


def known_unit(text: str) -> str | None:
    """The unit that a log states with this text, as UNITS calls it; None if it is none of them."""
    text = text.strip()
    apart = BETWEEN.sub(" ", text).strip()
    found = (KNOWN.get(own) for own in (text, apart, text.lower(), apart.lower()))
    return next((unit for unit in found if unit), None)


def is_stated(name: str, units: Iterable[tuple[str, str]]) -> bool:
    """Whether one of these patterns, each with its unit, is that of a column."""
    return any(fnmatchcase(name, pattern) for pattern, _ in units)


def unit_option(new: str, factor: str = "0.001") -> str:
    """The option that states what one unit of columns is, which become `new` ones (as tau*)."""
    kind = re.match("[a-z]*", new)
    return f"--unit '{new}={factor} {SI.get(kind[0] if kind else '', 'N m')}'"


def scale_of(text: str) -> tuple[float, str] | None:
    """The factor and the resulting unit of a text such as `deg`, or `0.001534 rad` per count."""
    first, _, rest = text.partition(" ")
    try:
        factor, unit = float(first), known_unit(rest)
    except ValueError:
        factor, unit = 1.0, known_unit(text)
    if unit is None or not 0.0 < abs(factor) < inf:
        return None
    own = UNITS.get(unit, (1.0, unit))
    return factor * own[0], own[1]
