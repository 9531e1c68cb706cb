"""The shape of the program: imports, help, documentation, packaging."""

from __future__ import annotations

import ast
import importlib
import inspect
import re
import subprocess
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path

import click
import pytest
from conftest import ROOT, Result
from importlinter.cli import lint_imports

from scarid_cli import __version__
from scarid_cli.algorithms.choices.registry import (
    DIFFERENTIATORS,
    ESTIMATORS,
    EXCITATIONS,
    Registry,
)
from scarid_cli.cli import COMMANDS
from scarid_cli.cli import scarid as scarid_group
from scarid_cli.cli.declaring import options
from scarid_cli.io import schemas
from scarid_cli.reporting import schemas as page

Run = Callable[..., Result]
HEAVY = ["jinja2", "matplotlib", "numpy", "pandas", "pyarrow", "pyarrow.compute", "rich", "scipy"]


def loaded(pipe_in: str, *words: str, cwd: Path) -> set[str]:
    """The heavy modules that a command has imported by its end."""
    script = (
        f"import atexit, sys; loaded = lambda: [m for m in {HEAVY} if sys.modules.get(m)];"
        "atexit.register(lambda: print(loaded(), file=sys.stderr));"
        "from scarid_cli.__main__ import run; run()"
    )
    done = subprocess.run(
        [sys.executable, "-c", script, *words],
        input=pipe_in, capture_output=True, text=True, check=True, cwd=cwd,
    )  # fmt: skip
    return set(re.findall(r"'([\w.]+)'", done.stderr.splitlines()[-1]))


@pytest.mark.parametrize("words", [["--help"], ["--version"], *([c, "--help"] for c in COMMANDS)])
def test_help_and_version_import_nothing_heavy(words: list[str], tmp_path: Path) -> None:
    assert loaded("", *words, cwd=tmp_path) == set()


STREAMING = {
    "filter": ["filter"],
    "differentiate": ["differentiate"],
    "identify": ["identify", "motion.csv", "--trace", "trace.csv"],
    "validate": ["validate", "motion.csv", "--parameters", "parameters.csv"],
    "trajgen": ["trajgen", "--duration", "2"],
    "simulate": ["simulate", "reference.csv"],
    "convert": ["convert"],
    "info": ["info"],
    "plot": ["plot"],
}


@pytest.mark.parametrize("name", STREAMING)
def test_a_streaming_stage_imports_numpy_and_pyarrow_only(
    name: str, scarid: Run, samples: Path, tmp_path: Path
) -> None:
    motion, parameters = tmp_path / "motion.csv", tmp_path / "parameters.csv"
    assert scarid("differentiate", samples / "scara2.csv", "-o", motion).status == 0
    assert scarid("identify", motion, "-o", parameters).status == 0
    assert scarid("trajgen", "--duration", 2, "-o", tmp_path / "reference.csv").status == 0
    log = (samples / "scara2.csv").read_text()
    assert loaded(log, *STREAMING[name], cwd=tmp_path) <= {"numpy", "pyarrow"}


def test_what_the_program_imports_it_declares() -> None:
    """The test extra brings packages along; a user has only the declared ones."""
    declared = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"][
        "dependencies"
    ]
    names = {re.split(r"\W", requirement)[0] for requirement in declared}
    imported = set()
    for path in (ROOT / "scarid_cli").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.Import):
                imported |= {alias.name.partition(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and not node.level:
                imported.add((node.module or "").partition(".")[0])
    # Of the extras `urdf`, where pinocchio is called pin, `sim`, `logs` and `hdf5`.
    extra = {"cvxpy", "h5py", "mujoco", "pinocchio", "rosbags"}
    assert imported - set(sys.stdlib_module_names) - {"scarid_cli"} == names | extra


def test_a_wheel_has_every_package_and_every_file_of_data() -> None:
    declared = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["setuptools"]
    listing = ["git", "ls-files", "scarid", "scarid_cli", "schemas"]
    done = subprocess.run(listing, cwd=ROOT, capture_output=True, text=True, check=True)
    tracked = done.stdout.split()
    folders = {Path(name).parent for name in tracked}
    packages = {".".join(folder.parts) for folder in folders if folder.parts[0] != "schemas"}
    assert set(declared["packages"]) == packages | {"scarid_cli.schemas"}
    data = declared["package-data"]
    for name in tracked:
        folders = [folder for folder in Path(name).parents if folder.parts]
        owners = (".".join(f.parts).replace("schemas", "scarid_cli.schemas") for f in folders)
        patterns = [*(pattern for owner in owners for pattern in data.get(owner, [])), "*.py"]
        assert any(Path(name).match(pattern) for pattern in patterns), name


def test_imports_follow_the_architecture(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    assert lint_imports(config_filename="pyproject.toml", no_cache=True) == 0


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_has_help_with_examples(name: str, scarid: Run) -> None:
    text = scarid(name, "--help").out
    examples = [line for line in text.splitlines() if line.strip().startswith("scarid ")]
    assert len(examples) >= 2
    assert not re.search(r"\.\.\.$", COMMANDS[name])


ACTIONS = [path.stem for path in (ROOT / "scarid_cli/cli/actions").glob("[a-z]*.py")]


@pytest.mark.parametrize("name", ACTIONS)
def test_an_action_takes_the_options_that_its_command_declares(name: str) -> None:
    command = scarid_group.get_command(click.Context(scarid_group), name)
    assert command
    declared = {parameter.name for parameter in command.params} - set(options.SHARED)
    action = importlib.import_module(f"scarid_cli.cli.actions.{name}")
    taken = inspect.signature(action.run).parameters.values()
    named = {parameter.name for parameter in taken if parameter.kind is not parameter.VAR_KEYWORD}
    assert named <= {"job", *declared}
    assert named == {"job", *declared} or len(named) < len(taken)


@pytest.mark.parametrize(
    ("command", "registry"),
    [("differentiate", DIFFERENTIATORS), ("identify", ESTIMATORS), ("trajgen", EXCITATIONS)],
)
def test_every_choice_is_listed_and_described(
    command: str, registry: Registry, scarid: Run
) -> None:
    text, found = scarid(command, "--help").out, scarid("methods").out
    for name in registry.names:
        assert re.search(rf"\b{name}\b", text)
        assert registry.summary(name) in found


@pytest.mark.parametrize("name", COMMANDS)
def test_help_follows_the_width_of_the_window(
    name: str, scarid: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Examples apart, which are shown as they are typed."""
    monkeypatch.setenv("COLUMNS", "90")
    for line in scarid(name, "--help").out.splitlines():
        typed = line.strip().startswith(("scarid ", "computed-torque "))
        assert len(line) <= 90 or typed, line


def test_the_help_of_differentiate_is_one_page(
    scarid: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    assert len(scarid("differentiate", "--help").out.splitlines()) <= 80


def test_the_readme_names_every_command() -> None:
    readme = (ROOT / "README.md").read_text("utf-8")
    assert [name for name in COMMANDS if not re.search(rf"`{name}[` ]", readme)] == []


def test_the_page_on_tables_is_up_to_date() -> None:
    assert (ROOT / "docs" / "tables.md").read_text("utf-8") == page.page()


def test_schemas_are_table_schemas() -> None:
    """What the Frictionless standard asks of a field: a name and one of its types."""
    for kind in (*schemas.KINDS, "via", "fleet", "estimates", "robots"):
        schema = schemas.load(kind)
        assert schema.kind == kind
        assert len({field.name for field in schema.fields}) == len(schema.fields)
        assert all(field.type in schemas.TYPES.values() for field in schema.fields)


def test_the_version_says_that_the_compiled_kernels_run(scarid: Run) -> None:
    assert scarid("--version").out == f"scarid {__version__} (kernels: compiled)\n"


def test_nothing_reveals_where_it_was_made() -> None:
    tracked = subprocess.run(
        ["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.split()
    pattern = re.compile(r"((?<![\w}])/(home|root|work|Users)/|https?://[^\s)\"']*pypi)")
    found = [
        name for name in tracked
        if name != "tests/cli/test_house.py" and (ROOT / name).is_file()
        and pattern.search((ROOT / name).read_text("utf-8", errors="ignore"))
    ]  # fmt: skip
    assert found == []


@pytest.mark.parametrize("registry", [DIFFERENTIATORS, ESTIMATORS, EXCITATIONS])
def test_methods_lists_every_choice_and_describes_each(registry: Registry, scarid: Run) -> None:
    listed = scarid("methods").out
    for name in registry.names:
        assert f"  {name} " in listed
        described = scarid("methods", name).out
        for line in registry.describe(name).splitlines():
            assert line.strip() in described
    assert "did you mean kalman?" in scarid("methods", "kalma").err
