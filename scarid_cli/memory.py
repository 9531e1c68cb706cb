"""How much memory this process may use."""

from __future__ import annotations

import os
import resource
from pathlib import Path

from scarid_cli.errors import UsageFault

VARIABLE = "SCARID_MEMORY"
UNITS = {"K": 2**10, "M": 2**20, "G": 2**30}
CGROUPS = ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes")


def limit() -> int:
    """The bytes that may be used.

    They are the least of SCARID_MEMORY, the control group, `ulimit -v` and the machine's memory.
    """
    limits = [_stated(), *(_of_group(path) for path in CGROUPS)]
    soft, _ = resource.getrlimit(resource.RLIMIT_AS)
    limits.append(soft if soft != resource.RLIM_INFINITY else None)
    limits.append(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    return min(known for known in limits if known)


def _stated() -> int | None:
    text = os.environ.get(VARIABLE, "").strip().upper().removesuffix("B").removesuffix("I")
    if not text:
        return None
    unit = UNITS.get(text[-1], 0)
    try:
        number = float(text[:-1] if unit else text)
        if not 0.0 < number < float("inf"):
            raise ValueError
    except ValueError:
        raise UsageFault(
            f"{VARIABLE}={os.environ[VARIABLE]}: expected bytes, such as 500M or 2G"
        ) from None
    return int(number * (unit or 1))


def _of_group(path: str) -> int | None:
    try:
        text = Path(path).read_text().strip()
    except OSError:
        return None
    return int(text) if text.isdigit() else None
