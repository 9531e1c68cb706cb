"""What commands read of a table's metadata beyond its kind: checked where it enters.

A table may come from anywhere. Whether the sizes agree with the rows and the robot is checked where
the values are used.
"""

from __future__ import annotations

from collections.abc import Callable
from math import isfinite
from typing import Any

Check = Callable[[Any], bool]
LARGEST = 1e100
FREQUENCIES = (1e-6, 1e9)  # Hz
ORDER = "two_sided_order"  # of the Butterworth filter that a motion has passed both ways


def number(x: Any) -> bool:
    """A number that can be calculated with."""
    return isinstance(x, int | float) and not isinstance(x, bool) and abs(x) <= LARGEST


def text(x: Any) -> bool:
    """A string."""
    return isinstance(x, str)


def truth(x: Any) -> bool:
    """True or false."""
    return isinstance(x, bool)


def _frequency(x: Any) -> bool:
    return number(x) and FREQUENCIES[0] <= x <= FREQUENCIES[1]


def _size(x: Any) -> bool:
    return number(x) and x >= 0.0


def _count(x: Any) -> bool:
    return isinstance(x, int) and not isinstance(x, bool) and 0 < x < 1 << 20


def _place(x: Any) -> bool:
    return x == 0 or _count(x)


def _or_none(check: Check) -> Check:
    return lambda x: x is None or check(x)


def _list(check: Check) -> Check:
    return lambda x: isinstance(x, list) and all(map(check, x))


def _of(checks: dict[str, Check]) -> Check:
    """A table with these keys at least."""
    return lambda x: isinstance(x, dict) and all(k in x and ok(x[k]) for k, ok in checks.items())


def _evidence(x: Any) -> bool:
    """The information matrix of an identification, by its lower triangle, with its columns."""
    parts = {"columns": _list(text), "score": _list(number), "deviations": _list(_size)}
    if not _of({**parts, "information": _list(number), "blocks": _count})(x):
        return False
    q, alone = len(x["score"]), len(x["columns"]) + 1
    joints = len(x["deviations"])
    # Older tables have nothing about zeros of the joints, or about tilts and low-passes.
    known = q in (alone + 2 * joints, alone + 3 * joints, alone + 3 * joints + 3)
    moves = x.get("biases", [])  # of each parameter by what the model may lack
    known = known and _list(_list(number))(moves) and all(len(m) == alone - 1 for m in moves)
    return known and len(x["information"]) == q * (q + 1) // 2


ADDITION = {"name": text, "joint": lambda x: isinstance(x, int) and 0 <= x < 1 << 20,
            "usual": _size, "size": _or_none(number), "cycles": _size}  # fmt: skip
SINCE = {"error": _or_none(_size)}  # which the additions of older tables have not


def _addition(x: Any) -> bool:
    """What was fitted beside the parameters (effects/additions.py)."""
    if not _of(ADDITION)(x):
        return False
    further = set(x) - set(ADDITION)
    return further <= set(SINCE) and all(SINCE[key](x[key]) for key in further)


def _gains(x: Any) -> bool:
    """The factor and its error for some joints, by their numbers."""
    return isinstance(x, dict) and all(
        k.isdigit() and _list(number)(v) and len(v) == 2 and v[1] > 0.0 for k, v in x.items()
    )


def _products(x: Any) -> bool:
    """The products of the rows of each joint, by the lower triangles (results/products.py)."""
    own = {"columns": _list(_place), "products": _list(number)}
    parts = {"joints": _list(_of(own)), "rows": _list(_size), "inflation": _size}
    if not _of({**parts, "biases": _list(_list(number))})(x) or len(x["rows"]) != len(x["joints"]):
        return False
    sizes = ((len(joint["columns"]) + 1, len(joint["products"])) for joint in x["joints"])
    return all(there == n * (n + 1) // 2 for n, there in sizes)


def _rows_of_joints(x: Any) -> bool:
    """A list for each parameter, with a number for each joint; one parameter at least, or none."""
    if not isinstance(x, dict):
        return False
    lengths = {len(row) if _list(number)(row) else 0 for row in x.values()}
    return not x or (len(lengths) == 1 and lengths != {0})


CHECKS: dict[str, Check] = {
    "bandwidth": _or_none(_frequency),
    ORDER: _or_none(_count),
    "velocity_noise": _or_none(_list(_size)),
    "delay": _or_none(number),
    "delay_error": _or_none(_size),
    "low_pass": truth,
    "additions": _list(_addition),
    "relative_gains": _gains,
    "widened_by_gains": lambda x: _list(_list(number))(x) and len(x) == 2,
    "covariance": _or_none(_list(_list(_or_none(number)))),
    "full_estimates": _or_none(_list(_or_none(number))),
    "dropped": _list(text),
    "verdict": text,
    "reasons": _list(text),
    "biased": truth,
    "evidence": _or_none(_evidence),
    "joint_products": _products,
    "wrong": _list(_count),
    "torque_gains": _or_none(_list(lambda x: number(x) and x > 0.0)),
    "torque_constants": _or_none(_rows_of_joints),
    "joints": lambda x: _list(text)(x) or _list(_of({"deviation": _or_none(_size)}))(x),
}


def sound(extra: dict[str, Any]) -> bool:
    """Whether what commands read of these metadata is of the type that they expect."""
    return all(check(extra[key]) for key, check in CHECKS.items() if key in extra) and (
        "verdict" not in extra or "reasons" in extra
    )


def period(x: Any) -> bool:
    """A sampling period [s], or none."""
    return x is None or (number(x) and isfinite(x) and x > 0.0)
