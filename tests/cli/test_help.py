"""What `--help` and `scarid help` say, and in what order."""

from __future__ import annotations

from collections.abc import Callable

import click
import pytest
from conftest import Result

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS, ESTIMATORS, EXCITATIONS
from scarid_cli.cli import COMMANDS
from scarid_cli.cli import scarid as group
from scarid_cli.cli.declaring.headings import DATA, ERRORS, METHOD, MODEL, OUTPUT

Run = Callable[..., Result]
MANY = 16  # options of one command, which a person does not look through without headings


def headings(text: str) -> list[str]:
    """The lines of a help that head a list."""
    return [
        line.rstrip(":") for line in text.splitlines() if line[:1].isalpha() and line[-1] == ":"
    ]


@pytest.mark.parametrize("name", COMMANDS)
def test_help_of_a_command_is_its_help(name: str, scarid: Run) -> None:
    assert scarid("help", name).out == scarid(name, "--help").out


def test_help_alone_lists_the_commands(scarid: Run) -> None:
    assert scarid("help").out == scarid("--help").out
    assert scarid("help", "robot", "check").out == scarid("robot", "check", "--help").out


@pytest.mark.parametrize(
    ("words", "reported"),
    [
        (("identfy",), "did you mean identify"),
        (("robot", "chek"), "'chek' in scarid robot"),
        (("filter", "x"), "scarid filter has no commands"),
    ],
)
def test_help_for_what_is_no_command_is_refused(
    words: tuple[str, ...], reported: str, scarid: Run
) -> None:
    result = scarid("help", *words)
    assert (result.status, result.out) == (2, "")
    assert reported in result.err


def options_of(name: str) -> tuple[click.Command, str]:
    """A command, and the part of its help that lists its options."""
    command = group.get_command(click.Context(group), name)
    assert command is not None
    formatter = click.HelpFormatter()
    command.format_options(click.Context(command), formatter)
    return command, formatter.getvalue()


def records(text: str) -> list[str]:
    return [line.split("   ")[0] for line in text.splitlines() if line.startswith("  -")]


@pytest.mark.parametrize("name", COMMANDS)
def test_many_options_stand_under_headings(name: str) -> None:
    for part in options_of(name)[1].split("\n\n"):
        assert len(records(part)) < MANY


def test_the_options_of_identify_are_in_the_order_of_its_work(scarid: Run) -> None:
    found = headings(scarid("identify", "--help").out)
    assert found[:5] == [DATA, METHOD, MODEL, ERRORS, OUTPUT]


@pytest.mark.parametrize("name", COMMANDS)
def test_every_option_is_shown_once(name: str) -> None:
    command, text = options_of(name)
    shown = [word.strip(",") for record in records(text) for word in record.split()]
    for option in (p for p in command.params if isinstance(p, click.Option)):
        assert all(shown.count(spelling) == 1 for spelling in option.opts), option.name


@pytest.mark.parametrize("registry", [DIFFERENTIATORS, ESTIMATORS, EXCITATIONS])
def test_what_is_recommended_is_there_and_marked(registry, scarid: Run) -> None:  # type: ignore[no-untyped-def]
    assert registry.recommended
    text = scarid("methods").out
    for name, use in registry.recommended.items():
        assert name in registry.names
        assert f"(recommended {use})" in text
