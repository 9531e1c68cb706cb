"""The failures a command can report, each with its documented exit status."""

OK = 0
BUG = 1
USAGE = 2
BAD_DATA = 65
IO_FAILURE = 74
INTERRUPTED = 130
BROKEN_PIPE = 141


class ScaridError(Exception):
    """A failure that is told in one line: where, what was found, what to do."""

    status = BAD_DATA


class UsageFault(ScaridError):
    """The command line asks for something that cannot be (exit 2)."""

    status = USAGE


class BadData(ScaridError):
    """The input is not what the command needs (exit 65)."""

    status = BAD_DATA


class TooShort(BadData):
    """A method needs more rows than a record, or a segment of it, has."""


class OutputFailure(ScaridError):
    """Reading or writing failed (exit 74)."""

    status = IO_FAILURE


def bad_data(
    where: str,
    found: str,
    *,
    expected: str,
    remedy: str,
    row: int | None = None,
    column: str | None = None,
) -> BadData:
    """The one-line message of section 4 of the command contract."""
    place = [where]
    if row is not None:
        place.append(f"row {row}")
    if column is not None:
        place.append(f"column {column}")
    return BadData(f"{', '.join(place)}: found {found}, expected {expected}; {remedy}")


def cut_short(where: str) -> BadData:
    """The stage before failed or was killed: its table is not whole."""
    return BadData(f"{where}: the table was cut short: the stage that wrote it failed")
