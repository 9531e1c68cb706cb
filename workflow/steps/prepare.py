"""convert, check, resample: from a log to a measurement at a constant rate."""

from __future__ import annotations

import json
import shlex
from pathlib import Path

from steps.commands import Result, failure, run
from steps.plan import Log, Robot

from scarid_cli.printable import utf8


def prepare(robot: Robot, log: Log, measurement: Path, findings: Path) -> Result:
    """Write the measurement of a log, and what `check` says of it."""
    messages: list[str] = []
    described = shlex.join(["--robot", robot.description])
    resample = robot.pipe["resample"]
    first = measurement.with_suffix(".converted.parquet") if resample else measurement
    convert = f"convert {described} {robot.pipe['convert']} {shlex.quote(log.file)}"
    tee = f"tee {shlex.quote(str(first))}"
    ran = run(f"{convert} then {tee} then check --json {described}", messages)
    if not ran.out:
        return {**failure(ran), "messages": messages}
    findings.write_text(utf8(ran.out), "utf-8")
    found = {"status": 0, "messages": messages, **_findings(ran.out)}
    if resample:
        words = ["resample", str(first), *shlex.split(resample), "-o", str(measurement)]
        ran = run(words, messages)
        first.unlink()
        found |= failure(ran) if ran.status else {}
    return found


def _findings(document: str) -> Result:
    """The worst status, and the findings that are not ok."""
    found = json.loads(document)
    texts = [f"{c['name']}: {c['figure']}" for c in found["checks"] if c["status"] != "ok"]
    return {"check": found["status"], "findings": "; ".join(texts)}
