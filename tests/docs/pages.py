"""The code blocks of the documentation: which are run, and what they show (CONTRIBUTING.md).

A block that begins with ```sh is run. The block that follows it directly, if it begins with a
plain ```, is what it prints: lines that begin with `scarid COMMAND:` on standard error, all others
on standard output. A line `...` stands for any number of lines.
"""

from __future__ import annotations

import re
import textwrap
from dataclasses import dataclass, replace
from pathlib import Path

from conftest import ROOT, SHARED, assert_alike

PAGES = sorted(
    str(path.relative_to(ROOT))
    for path in (
        *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "DESIGN.md")),
        *(ROOT / "docs").glob("*.md"),
        *(ROOT / "docs" / "howto").glob("*.md"),
        ROOT / "samples" / "README.md",
    )
    if path.is_file()
)

# Lines that begin with these words are not run: they install something, change the shell of the
# reader, or take minutes (make, and the benchmarks behind it).
NOT_RUN = re.compile(r"(make|pip|source|git|python|ruff|\.ci/run)\b|\.venv/")
REAL_LOG = re.compile(r"\bDATA/|\bemps_(train|test_pulses)\.csv|\btx40\.toml")
WRITTEN = re.compile(r"-o (\S+)|\bexport (\w+)=")
MESSAGE = re.compile(r"scarid( \w+)*: ")
FENCE = re.compile(r"^(?P<indent> *)```(?P<info>.*)$")


@dataclass(frozen=True)
class Block:
    """A block of shell commands at a line of a page, and the output shown below it."""

    page: str
    line: int
    info: str
    text: str
    shown: str | None = None
    real: bool = False  # it needs the real logs, or what a block above makes of them

    @property
    def place(self) -> str:
        return f"{self.page}:{self.line}"

    @property
    def end(self) -> int:
        """The line of the fence that closes it."""
        return self.line + len(self.text.splitlines()) + 1

    @property
    def commands(self) -> str:
        """The lines that are run."""
        lines = (line for line in self.text.splitlines() if not NOT_RUN.match(line))
        return "\n".join(lines).strip()

    @property
    def slow(self) -> bool:
        return "slow" in self.info.split()

    @property
    def lacks(self) -> str | None:
        """What the block needs and is not here."""
        if self.real and not (SHARED / "data").is_dir():
            return f"{self.place} needs the real robot logs (../shared/data)"
        return None

    def prints(self, out: str, err: str) -> bool:
        """Whether this output is the one shown; messages may be left out of what is shown."""
        shown = (self.shown or "").splitlines()
        messages = [line for line in shown if MESSAGE.match(line)]
        table = [line for line in shown if not MESSAGE.match(line)]
        said = iter(err.splitlines())
        reported = all(any(alike(line, message) for line in said) for message in messages)
        return reported and matches(out.splitlines(), table)


def blocks(page: str) -> list[Block]:
    """The shell blocks of a page, in order."""
    found: list[Block] = []
    directly = False
    for line, info, text in fenced((ROOT / page).read_text("utf-8")):
        language = info.split()[0] if info else ""
        if directly and not language and line <= found[-1].end + 2:
            found[-1] = replace(found[-1], shown=text)
        directly = language == "sh"
        if directly:
            found.append(Block(page, line, info, text))
    return with_real(found)


def with_real(page: list[Block]) -> list[Block]:
    """The blocks of a page, of which those are marked that the real logs are needed for."""
    made: set[str] = set()
    found = []
    for block in page:
        written = {file or variable for file, variable in WRITTEN.findall(block.text)}
        written = {"scarid " if name == "SCARID_ROBOT" else name for name in written}
        made -= written
        real = bool(REAL_LOG.search(block.text)) or any(name in block.text for name in made)
        if real:
            made |= written
        found.append(replace(block, real=real))
    return found


def fenced(text: str) -> list[tuple[int, str, str]]:
    """Line, info string and text of each fenced block; an indented one belongs to a list."""
    found, opened, info = [], 0, ""
    lines = text.splitlines()
    for number, line in enumerate(lines, start=1):
        fence = FENCE.match(line)
        if fence and not opened:
            opened, info = number, fence["info"].strip()
        elif fence:
            found.append((opened, info, textwrap.dedent("\n".join(lines[opened : number - 1]))))
            opened = 0
    return found


def matches(found: list[str], shown: list[str]) -> bool:
    """Whether the lines are those shown."""
    if not shown:
        return not found
    if shown[0].strip() == "...":
        return any(matches(found[k:], shown[1:]) for k in range(len(found) + 1))
    return bool(found) and alike(found[0], shown[0]) and matches(found[1:], shown[1:])


def alike(found: str, shown: str) -> bool:
    try:
        assert_alike(found.rstrip(), shown.rstrip())
    except AssertionError:
        return False
    return True


def prose(page: Path) -> str:
    """A page without its code blocks."""
    return re.sub(r"^ *```.*?^ *```$", "", page.read_text("utf-8"), flags=re.DOTALL | re.MULTILINE)
