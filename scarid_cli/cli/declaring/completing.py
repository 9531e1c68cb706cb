"""What the shell offers at the Tab key, beside the options and choices that click knows.

The functions have the form that click asks of `shell_complete`. An error offers nothing: it would
be printed into the line that somebody is typing.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterable, Iterator
from typing import Any

import click
from click.shell_completion import (
    CompletionItem,
    ShellComplete,
    get_completion_class,
    split_arg_string,
)

from scarid_cli.cli.running.chain import split

VARIABLE = "_SCARID_COMPLETE"  # which the scripts set, such as to bash_complete
SHELLS = ("bash", "zsh", "fish")
HEAD = 65536  # bytes of a text within which its header ends
PLAIN_ZSH = "compadd -U -V unsorted -- ${completions:#*=}"
VALUED_ZSH = "compadd -U -V unsorted -S '' -- ${(M)completions:#*=}"
Items = list[CompletionItem]


def script(group: click.Group, shell: str) -> str:
    """The script that makes a shell ask scarid at the Tab key."""
    text = ShellComplete.source(_asked(group, shell))  # bash's own would start a bash first
    # No space after a name that a value follows; fish sees that by itself.
    plain = "COMPREPLY+=($value)"
    text = text.replace(plain, f"{plain}; [[ $value == *= ]] && compopt -o nospace")
    plain = "compadd -U -V unsorted -a completions"
    text = text.replace(plain, f"{PLAIN_ZSH}; {VALUED_ZSH}")
    # The first comma ends the kind of an item; the others belong to a list.
    return text.replace('string split ","', 'string split -m 1 ","')


def answer(group: click.Group, instruction: str) -> None:
    """Print what may follow the words in the environment, as the script of the shell reads it."""
    with contextlib.suppress(Exception, KeyboardInterrupt):
        asked = _asked(group, instruction.partition("_")[0])
        words, incomplete = asked.get_completion_args()
        for item in asked.get_completions(split(words)[-1], incomplete):
            click.echo(asked.format_completion(item))


def _asked(group: click.Group, shell: str) -> ShellComplete:
    kind = get_completion_class(shell)
    if kind is None:
        raise ValueError(f"no shell {shell!r}")
    return kind(group, {}, "scarid", VARIABLE)


def matching(names: Iterable[str], incomplete: str) -> Items:
    """The names that the word may become."""
    return [CompletionItem(name) for name in names if name.startswith(incomplete)]


def file(_context: click.Context, _parameter: click.Parameter, incomplete: str) -> Items:
    """A file, which the shell completes itself."""
    return [CompletionItem(incomplete, type="file")]


def robots() -> list[str]:
    """The robots that come with scarid."""
    from scarid_cli.algorithms.robots.reading import built_in

    return built_in()


def commands(context: click.Context, _parameter: click.Parameter, incomplete: str) -> Items:
    """The commands, as words of `scarid help`."""
    group = context.find_root().command
    assert isinstance(group, click.Group)
    return matching(group.list_commands(context), incomplete)


def methods(_context: click.Context, _parameter: click.Parameter, incomplete: str) -> Items:
    """The methods of all commands."""
    from scarid_cli.cli.methods import REGISTRIES

    names = {name for registry in REGISTRIES.values() for name in registry.names}
    return matching(sorted(names), incomplete)


def settings(context: click.Context, _parameter: click.Parameter, incomplete: str) -> Items:
    """The settings of the method that the line names, else of the default one."""
    from scarid_cli.algorithms.choices.settings import names_of

    return matching([f"{name}=" for name in names_of(_method(context))], incomplete)


def presets(context: click.Context, _parameter: click.Parameter, incomplete: str) -> Items:
    """The presets of the differentiator."""
    return matching(_method(context).PRESETS, incomplete)


def imperfections(_context: click.Context, _parameter: click.Parameter, incomplete: str) -> Items:
    """The imperfections of a simulated robot."""
    from scarid_cli.algorithms.imperfections.registry import IMPERFECTIONS

    return matching([f"{name}=" for name in IMPERFECTIONS], incomplete)


def parameters(context: click.Context, parameter: click.Parameter, incomplete: str) -> Items:
    """The parameters of the robot; those that a value follows, with the sign before it."""
    from scarid_cli.algorithms.robots.reading import DEFAULT_ROBOT, load

    robot = context.params.get("robot") or os.environ.get("SCARID_ROBOT") or DEFAULT_ROBOT
    sign = "=" if "=" in (parameter.metavar or "") else ""
    names = [f"{known.name}{sign}" for known in load(robot).parameters]
    return _listed(names, incomplete)


def aims(context: click.Context, parameter: click.Parameter, incomplete: str) -> Items:
    """What a motion can be planned for: parameters of the robot, or one of the two words."""
    from scarid_cli.algorithms.design.aims import AIMS

    words = matching(list(AIMS), incomplete)
    return [*words, *parameters(context, parameter, incomplete)]


def columns(_context: click.Context, _parameter: click.Parameter, incomplete: str) -> Items:
    """The columns of the first table that the line names."""
    return _listed(_columns_of_line(), incomplete)


DEFAULTS = {"differentiate": ("method", "kalman"), "identify": ("estimator", "rls"),
            "trajgen": ("excitation", "quintic")}  # fmt: skip


def _method(context: click.Context) -> Any:
    """The class of the method that the line names."""
    from scarid_cli.cli.methods import REGISTRIES

    option, default = DEFAULTS[context.info_name or ""]
    registry = REGISTRIES[f"{context.info_name} --{option}"]
    return registry.load(context.params.get(option) or default)


def _columns_of_line() -> list[str]:
    for word in split_arg_string(os.environ["COMP_WORDS"])[1:]:
        if os.path.isfile(word):  # noqa: PTH113 (pathlib takes a while to import)
            return list(_columns(word))
    return []


def _columns(path: str) -> Iterator[str]:
    """The names of the columns of a table."""
    with open(path, "rb") as stream:  # noqa: PTH123 (likewise)
        head = stream.read(HEAD)
    if head.startswith(b"PAR1"):
        from pyarrow import parquet

        yield from parquet.read_schema(path).names
    elif head.startswith((b"ARROW1", b"\xff\xff\xff\xff")):
        import pyarrow as pa

        opened = pa.ipc.open_file if head.startswith(b"ARROW1") else pa.ipc.open_stream
        with pa.memory_map(path) as source:
            yield from opened(source).schema.names
    else:
        lines = head.decode("utf-8", "replace").splitlines()
        header = next((line for line in lines if not line.startswith("#")), "")
        yield from (name.strip().strip('"') for name in header.split(","))


def _listed(names: Iterable[str], incomplete: str) -> Items:
    """The names that may be the last one of a list with commas."""
    before, comma, last = incomplete.rpartition(",")
    return matching([f"{before}{comma}{name}" for name in names], f"{before}{comma}{last}")
