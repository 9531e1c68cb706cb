"""Where in a TOML file a key stands that its table does not have."""

from __future__ import annotations

import re
from difflib import get_close_matches

HEADER = re.compile(r"\s*\[+\s*([^\]]+?)\s*\]+")


class UnknownKey(ValueError):
    """A key that its table does not have; `known` are those that it may have."""

    def __init__(self, what: str, key: str, known: list[str]) -> None:
        near = get_close_matches(key, known, 1)
        hint = f" (is it {near[0]}?)" if near else ""
        super().__init__(f"{key} is not a key of {what}{hint}; its keys are {', '.join(known)}")
        self.table = what.split("[")[-1].split("]")[0] if "[" in what else ""
        self.key = key


def line_of(text: str, table: str, key: str) -> int | None:
    """The line, counted from 1, of a key in a table [table] or [[table]], or at the top ("").

    None if it is written in another way than `key =` or `[key]` at the start of a line.
    """
    name = rf"(?:{re.escape(key)}|\"{re.escape(key)}\"|'{re.escape(key)}')"
    stated = re.compile(rf"\s*{name}\s*[.=]")
    within = ""
    for number, line in enumerate(text.splitlines(), start=1):
        if header := HEADER.match(line):
            within = header[1]
            if not table and re.split(r"\s*\.\s*", within)[0] == key:
                return number
        elif within == table and stated.match(line):
            return number
    return None
