"""The products of the rows of each joint in the metadata of a parameter table."""

from __future__ import annotations

from typing import Any

import numpy as np

from scarid_cli.algorithms.beyond.torques import RelativeGain
from scarid_cli.algorithms.changes.known_load import Judged
from scarid_cli.algorithms.inference.outcome import Outcome
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.uncertainty.joint_products import JointProducts
from scarid_cli.errors import BadData, bad_data
from scarid_cli.io.table import Table
from scarid_cli.stages.records.corrected import gains_of

PRODUCTS = "joint_products"  # key of the metadata
REMEDY = "write the table with `identify -o parameters.parquet`"


def stored_products(found: Outcome) -> dict[str, Any] | None:
    """As the metadata keep them: of each joint the lower triangle, row by row, of what it has."""
    products = found.products
    if products is None or not np.isfinite(products.values).all():
        return None
    effects = found.effects
    return {
        "joints": [_packed(values) for values in products.values],
        "rows": products.counts.tolist(),
        "inflation": float(products.inflation),
        "biases": [
            np.nan_to_num(x.bias).tolist()
            for x in effects
            if x.name != RelativeGain.NAME and np.any(x.bias)
        ],
    }


def _packed(values: Any) -> dict[str, list[Any]]:
    """The columns that a joint has, and the products of these and of the torque."""
    own = np.flatnonzero(np.diag(values)[:-1])
    at = [*own, len(values) - 1]
    part = values[np.ix_(at, at)]
    return {"columns": own.tolist(), "products": part[np.tril_indices(len(part))].tolist()}


def products_of(table: Table, robot: Robot) -> Judged:
    """What the metadata of a parameter table say about the rows of each joint, as logged."""
    stored = table.meta.extra.get(PRODUCTS)
    if stored is None:
        raise BadData(
            f"{table.name}: no products of the rows of each joint, which gains need (CSV cannot "
            f"hold them, and older tables do not); {REMEDY}"
        )
    p, joints = len(robot.names), len(robot.joints)
    largest = max((max(joint["columns"], default=-1) for joint in stored["joints"]), default=-1)
    moves = [len(bias) for bias in stored["biases"]]
    if len(stored["joints"]) != joints or largest >= p or any(n != p for n in moves):
        raise bad_data(
            table.name,
            "products of another robot in its metadata",
            expected=f"those of {robot.name}, with {p} parameters",
            remedy="state the robot that the log was identified with (--robot)",
        )
    values = np.zeros((joints, p + 1, p + 1))
    for own, joint in zip(values, stored["joints"], strict=True):
        at = np.array([*joint["columns"], p])
        lower = np.zeros((len(at), len(at)))
        lower[np.tril_indices(len(at))] = joint["products"]
        own[np.ix_(at, at)] = lower + np.tril(lower, -1).T
    gains = np.array(gains_of(table) or np.ones(joints))[:, None]
    values[:, -1] *= gains  # of the torques as they were logged
    values[:, :, -1] *= gains
    products = JointProducts(values, np.array(stored["rows"]), stored["inflation"])
    return Judged(products, np.array(stored["biases"]).reshape(-1, p))
