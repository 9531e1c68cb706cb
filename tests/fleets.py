"""Small outcomes of a batch, for the tests of the fleet page."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

from outcomes import done, estimate, failed, robot, write


def small(folder: Path) -> Path:
    """Three robots: one is fine, one drifts, and one has a failed and a doubtful log."""
    logs = [done("steady", i) for i in (1, 2, 3)]
    drift = {"change": "changed", "compare": "differs", "differing": "Fs2, Fv1", "p_value": 1e-9}
    drift |= {"change_reason": "friction of joint 2", "page": "logs/drifting/3/report.html"}
    logs += [done("drifting", 1), done("drifting", 2), done("drifting", 3, **drift)]
    doubtful = {"verdict": "doubtful", "reasons": "too slow", "check": "warning"}
    doubtful |= {"findings": "clock: 3 gaps"}
    said = "scarid convert: logs/mixed/2026-01-03.csv, row 5: found 12 values"
    logs += [done("mixed", 1), done("mixed", 2, **doubtful), failed("mixed", 3, said)]
    estimates = [
        estimate(name, i, parameter, 1.0 + (name == "drifting") * 0.1 * i)
        for name in ("steady", "drifting")
        for i in (1, 2, 3)
        for parameter in ("Fs2", "Fv1")
    ]
    trend = "trend over the 3 tables, per table: Fs2 +0.1 N m (9 errors)"
    robots = [robot("steady"), robot("drifting", trend=trend, trending="Fs2"), robot("mixed")]
    return write(folder, fleet=logs, estimates=estimates, robots=robots)


def data(page: str) -> dict[str, Any]:
    """What the script of a page is given."""
    match = re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.DOTALL)
    assert match
    found: dict[str, Any] = json.loads(match.group(1))
    return found
