"""The pages, read from the declarations of the commands: what `--help` says, and more."""

from __future__ import annotations

import contextlib
import inspect
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import click

from scarid_cli.cli import COMMANDS, scarid
from scarid_cli.cli.manual import common
from scarid_cli.cli.manual.common import Entries

VERBATIM = "\b"  # begins a paragraph whose lines click does not wrap


@dataclass(frozen=True)
class Paragraph:
    """Some lines of text, to be wrapped unless they are verbatim."""

    text: str
    verbatim: bool = False


@dataclass(frozen=True)
class Section:
    """A heading with a list of terms and what they mean; without any, a heading of headings."""

    title: str
    entries: Entries


@dataclass(frozen=True)
class Page:
    """The page of one command."""

    words: tuple[str, ...]
    """Such as ("scarid", "robot", "check")."""
    summary: str
    usage: str
    text: list[Paragraph]
    options: list[Section]
    more: list[Section]
    """What stands below the options: commands, methods, imperfections."""
    examples: list[Paragraph]
    statuses: Entries
    files: Entries
    environment: Entries
    also: list[tuple[str, ...]]

    @property
    def name(self) -> str:
        """The name of the page, such as scarid-robot-check."""
        return "-".join(self.words)


def pages() -> list[Page]:
    """The page of scarid, and one for each command, in the order of `scarid --help`."""
    context = click.Context(scarid, info_name="scarid", **scarid.context_settings)
    found = [_page(context, "From a robot's log to dynamic parameters you can trust.")]
    for name, summary in COMMANDS.items():
        command = scarid.get_command(context, name)
        assert command is not None
        found += _of(click.Context(command, context, info_name=name), summary)
    return found


def _of(context: click.Context, summary: str) -> Iterator[Page]:
    """The page of a command, and those of its own commands."""
    yield _page(context, summary)
    if isinstance(context.command, click.Group):
        for name, command in context.command.commands.items():
            inner = click.Context(command, context, info_name=name)
            yield _page(inner, command.get_short_help_str(200))


def _page(context: click.Context, summary: str) -> Page:
    command = context.command
    words = tuple(context.command_path.split())
    text = _paragraphs(command)
    examples = _examples(text)
    whole = words == ("scarid",)
    if whole:
        statuses, files, environment = map(
            common.every, (common.STATUSES, common.FILES, common.ENVIRONMENT)
        )
    else:
        statuses, files, environment = (
            common.of(command, known)
            for known in (common.STATUSES, common.FILES, common.ENVIRONMENT)
        )
    return Page(
        words=words,
        summary=summary.rstrip("."),
        usage=" ".join(command.collect_usage_pieces(context)),
        text=[p for p in text if p not in examples],
        options=_captured(context, command.format_options, without="Commands"),
        more=_more(context),
        examples=examples,
        statuses=statuses,
        files=files,
        environment=environment,
        also=_also(words),
    )


def _also(words: Sequence[str]) -> list[tuple[str, ...]]:
    if len(words) == 1:
        return [("scarid", name) for name in COMMANDS]
    inner = [("scarid", "robot", "check")] if words[-1] == "robot" else []
    known = [("scarid",), *inner, ("scarid", "help"), ("scarid", "methods")]
    return [other for other in known if other != tuple(words)]


def _paragraphs(command: click.Command) -> list[Paragraph]:
    text = inspect.cleandoc(command.help or "")
    return [_paragraph(part) for part in re.split(r"\n\s*\n", text)]


def _paragraph(part: str) -> Paragraph:
    if part.startswith(VERBATIM):
        lines = part.removeprefix(VERBATIM).strip("\n").splitlines()
        return Paragraph(inspect.cleandoc("\n" + "\n".join(lines)), verbatim=True)
    return Paragraph(" ".join(part.split()))


def _examples(text: list[Paragraph]) -> list[Paragraph]:
    """Command lines, but for those that the paragraph before them introduces."""
    before = ["", *(paragraph.text for paragraph in text)]
    return [
        paragraph
        for paragraph, last in zip(text, before, strict=False)
        if paragraph.verbatim and paragraph.text.startswith("scarid ") and not last.endswith(":")
    ]


def _more(context: click.Context) -> list[Section]:
    """The commands of a group, and what a command lists at the end of its help."""
    command = context.command
    found = []
    if isinstance(command, click.Group):
        found += _captured(context, command.format_commands)
    if type(command).format_epilog is not click.Command.format_epilog:
        found += _captured(context, command.format_epilog)
    return found


class _Captured(click.HelpFormatter):
    """A formatter that keeps what it is given, in place of formatting it."""

    def __init__(self) -> None:
        super().__init__()
        self.sections: list[Section] = []

    @contextlib.contextmanager
    def section(self, name: str) -> Iterator[None]:
        self.write(name)
        yield

    def write(self, string: str) -> None:
        self.sections.append(Section(string.strip(), []))

    def write_dl(
        self,
        rows: Iterable[tuple[str, str]],
        col_max: int = 30,  # noqa: ARG002
        col_spacing: int = 2,  # noqa: ARG002
    ) -> None:
        self.sections[-1].entries.extend((_spaced(term), text) for term, text in rows)


def _spaced(term: str) -> str:
    """A term without the spaces that align it; two words of a table stay apart."""
    return re.sub(r"\s{2,}", "  ", term.strip())


def _captured(context: click.Context, write: object, without: str = "") -> list[Section]:
    formatter = _Captured()
    assert callable(write)
    write(context, formatter)
    return [section for section in formatter.sections if section.title != without]
