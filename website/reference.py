"""Pages made of what the commands and methods declare: their help, in Markdown."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator
from pathlib import Path

import click
from relinking import relinked, title

from scarid_cli.cli import COMMANDS, scarid
from scarid_cli.cli.declaring.headings import KEY, OUTPUT
from scarid_cli.cli.methods import REGISTRIES

ROOT = Path(__file__).resolve().parent.parent
WIDTH = 96  # characters: of what a command lists below its options
VERBATIM = "\b"  # click's mark of a paragraph that is not to be wrapped
SPECIAL = re.compile(r"(`[^`]*`)|(--[a-z][\w-]*)|([*<>|\[\]])")
# A line of a method's description that begins an item: `Delay: ...`, `gate = 20: ...`.
ITEM = re.compile(r"(Delay|Rule|Matched[\w ]*|[a-z][\w ,]*(?: = [^:]+)+)(?: \([^)]*\))?:? ")
SETTING = re.compile(r"^([a-z][\w ,]*(?: = [^\s:]+)+)(?=[:\s])")

STATUS = """## Exit status

0 after success, 2 after wrong usage, 65 for bad data, 74 if reading or writing failed;
[all statuses](../exit-statuses.md).
"""
FAILURES = "[Failures](../pipes.md#failures) of one command in a pipe, and what becomes of files."


def reference() -> dict[str, str]:
    """The text of each generated page, by its name on the site."""
    commands = {f"reference/commands/{name}.md": _command(name) for name in COMMANDS}
    return commands | {
        "reference/methods.md": _methods(),
        "reference/exit-statuses.md": _statuses(),
    }


def _command(name: str) -> str:
    context = click.Context(scarid, info_name="scarid")
    command = scarid.get_command(context, name)
    assert command
    lines = [f"# scarid {name}", "", *_described(command, context)]
    if isinstance(command, click.Group):
        inner = click.Context(command, info_name=name, parent=context)
        for word in command.list_commands(inner):
            below = command.get_command(inner, word)
            assert below
            lines += [f"## scarid {name} {word}", "", *_described(below, inner)]
    return "\n".join((*lines, STATUS))


def _described(command: click.Command, parent: click.Context) -> Iterator[str]:
    """The help of a command: what it does, examples, usage, options under their headings."""
    context = click.Context(command, info_name=command.name, parent=parent)
    for paragraph in inspect.cleandoc(command.help or "").split("\n\n"):
        yield from _paragraph(paragraph)
        yield ""
    usage = " ".join((context.command_path, *command.collect_usage_pieces(context)))
    yield from ("```text", usage, "```", "")
    for heading, records in _options(command, context).items():
        yield from (f"## {heading}", "")
        for names, text in records:
            yield from (f"`{names}`", f":   {escaped(text)}", "")
    after = click.HelpFormatter(width=WIDTH)
    command.format_epilog(context, after)
    if listed := after.getvalue().strip():
        yield from ("## Choices", "", "```text", listed, "```", "")


def _paragraph(text: str) -> Iterator[str]:
    if not text.startswith(VERBATIM):
        yield escaped(text)
        return
    lines = [line.removeprefix("  ") for line in text.splitlines()[1:]]
    yield from ("```sh" if lines[0].startswith("scarid") else "```text", *lines, "```")


def _options(command: click.Command, context: click.Context) -> dict[str, list[tuple[str, str]]]:
    """The names and the help of the options, under the headings of `scarid COMMAND --help`."""
    sections: dict[str, list[tuple[str, str]]] = {}
    for parameter in command.get_params(context):
        if not isinstance(parameter, click.Option):
            continue
        own = parameter in command.params
        title = vars(parameter).get(KEY, "Options") if own else OUTPUT
        if record := parameter.get_help_record(context):
            sections.setdefault(title, []).append(record)
    return sections


def escaped(text: str) -> str:
    """Text as Markdown that shows it; what stands in backticks is code, as options are."""

    def shown(found: re.Match[str]) -> str:
        code, option, mark = found.groups()
        return code or (f"`{option}`" if option else f"\\{mark}")

    return SPECIAL.sub(shown, " ".join(text.split()))


def _statuses() -> str:
    """The table of the page on pipes, by itself."""
    page = (ROOT / "docs" / "pipes.md").read_text("utf-8")
    table = re.search(r"^\| exit status.*?(?=\n\n)", page, flags=re.DOTALL | re.MULTILINE)
    assert table, "docs/pipes.md has no table of exit statuses"
    linked = relinked(table[0], "docs/pipes.md", lambda path: title(ROOT / path))
    return f"# Exit statuses\n\n{linked.replace('](', '](../')}\n\n{FAILURES}\n"


def _methods() -> str:
    lines = ["# Methods", "", "What `scarid methods NAME` prints, for every method.", ""]
    for option, registry in REGISTRIES.items():
        lines += [f"## {option}", ""]
        for name in registry.names:
            lines += [f"### {name}", "", *_items(registry.describe(name)), ""]
    return "\n".join(lines)


def _items(text: str) -> Iterator[str]:
    """The description of a method: paragraphs, then a list of its properties and settings."""
    listed = False
    for paragraph in text.split("\n\n"):
        parts: list[str] = []
        for line in paragraph.splitlines():
            if ITEM.match(line) or not parts:
                parts.append(line)
            else:
                parts[-1] += f" {line}"
        for part in parts:
            item = bool(ITEM.match(part))
            if not item or not listed:
                yield ""
            text = escaped(SETTING.sub(r"`\1`", part))
            yield f"- {text}" if item else text
            listed = item
