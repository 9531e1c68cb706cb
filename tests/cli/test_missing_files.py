"""Every option that names an input file says in the same way that the file cannot be read."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from pathlib import Path

import click
import pytest
from conftest import Result, refused

from scarid_cli.cli import COMMANDS
from scarid_cli.cli import scarid as group
from scarid_cli.cli.declaring import options
from scarid_cli.errors import OutputFailure
from scarid_cli.io.bytesource import ByteSource

Run = Callable[..., Result]
# What a command line needs besides the option that is tried.
REQUIRED = {"validate": ["--parameters"], "urdf": ["--parameters"], "resample": ["--rate"]}


def commands() -> Iterator[tuple[list[str], click.Command]]:
    """Every command, and the words that call it."""
    for name in COMMANDS:
        command = group.get_command(click.Context(group), name)
        assert command
        if isinstance(command, click.Group):
            yield from (([name, below], sub) for below, sub in command.commands.items())
        else:
            yield [name], command


def inputs() -> Iterator[tuple[list[str], click.Parameter, str]]:
    """Every parameter that names an input file, with the endings that such a file may have."""
    for words, command in commands():
        for parameter in command.params:
            if isinstance(parameter.type, options.InputFile):
                yield from ((words, parameter, ending) for ending in parameter.type.endings)


CASES = [
    pytest.param(words, parameter, ending, id=" ".join([*words, parameter.opts[-1] + ending]))
    for words, parameter, ending in inputs()
]


def line(words: list[str], parameter: click.Parameter, path: Path, samples: Path) -> list[object]:
    """A command line with this path, and everything else that the command requires."""
    log = samples / "scara2.csv"
    given = {"--parameters": samples / "scara2.parameters.csv", "--rate": 100}
    option = [] if isinstance(parameter, click.Argument) else [max(parameter.opts, key=len)]
    own = option[0] if option else (parameter.metavar or "")
    more: list[object] = []
    for name in REQUIRED.get(words[0], []):
        if name != own:
            more += [name, given[name]]
    takes_log = words[0] not in ("trajgen", "urdf", "robot") and bool(option)
    return [*words, *more, *option, path, *([log] if takes_log else [])]


@pytest.mark.parametrize(("words", "parameter", "ending"), CASES)
def test_a_missing_file_is_a_mistake_of_the_command_line(
    words: list[str], parameter: click.Parameter, ending: str, scarid: Run, samples: Path,
    tmp_path: Path,
) -> None:  # fmt: skip
    path = tmp_path / f"nowhere{ending}"
    result = scarid(*line(words, parameter, path, samples))
    refused(result, 2)
    assert result.err.endswith(f": {path}: no such file\n")


@pytest.mark.parametrize(("words", "parameter", "ending"), CASES)
def test_a_directory_is_an_input_failure(
    words: list[str], parameter: click.Parameter, ending: str, scarid: Run, samples: Path,
    tmp_path: Path,
) -> None:  # fmt: skip
    path = tmp_path / f"folder{ending}"
    path.mkdir()
    refused(scarid(*line(words, parameter, path, samples)), 74, f"{path}: Is a directory")


@pytest.mark.skipif(os.geteuid() == 0, reason="the superuser may read every file")
@pytest.mark.parametrize(("words", "parameter", "ending"), CASES)
def test_a_file_without_permission_is_an_input_failure(
    words: list[str], parameter: click.Parameter, ending: str, scarid: Run, samples: Path,
    tmp_path: Path,
) -> None:  # fmt: skip
    path = tmp_path / f"secret{ending}"
    path.touch(mode=0)
    refused(scarid(*line(words, parameter, path, samples)), 74, f"{path}: Permission denied")


def test_a_path_below_a_file_is_an_input_failure(scarid: Run, samples: Path) -> None:
    path = samples / "scara2.csv" / "log.csv"
    refused(scarid("info", path), 74, f"{path}: Not a directory")


@pytest.mark.parametrize("read", [ByteSource.read, ByteSource.filled])
def test_a_source_that_fails_is_an_input_failure(
    read: Callable[[ByteSource, int], object], tmp_path: Path
) -> None:
    """A directory can be opened but not read."""
    source = ByteSource.open(str(tmp_path))
    with pytest.raises(OutputFailure, match="Is a directory"):
        read(source, 8)
    source.close()


def test_the_options_that_name_files_are_those_that_are_tried() -> None:
    """An option whose value is a file to read is declared as one."""
    tried = {(" ".join(case.values[0]), case.values[1].name) for case in CASES}
    for words, command in commands():
        for parameter in command.params:
            names_a_file = "FILE" in (parameter.metavar or "")
            if names_a_file and not isinstance(parameter, options.Unrecorded):
                assert (" ".join(words), parameter.name) in tried
