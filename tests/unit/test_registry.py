"""A folder is a registry, and what a method says of its settings is what they are."""

from __future__ import annotations

import importlib
import re
from dataclasses import fields, is_dataclass
from math import inf
from typing import Any

import pytest

from scarid_cli.algorithms.choices.registry import (
    ALGORITHMS,
    DIFFERENTIATORS,
    ESTIMATORS,
    EXCITATIONS,
    Registry,
)
from scarid_cli.algorithms.choices.settings import names_of
from scarid_cli.algorithms.processes.method import Matching, Method
from scarid_cli.errors import UsageFault

REGISTRIES = {registry.folder: registry for registry in (DIFFERENTIATORS, ESTIMATORS, EXCITATIONS)}
CHOICES = [
    pytest.param(registry, name, id=name)
    for registry in REGISTRIES.values()
    for name in registry.names
]
every_choice = pytest.mark.parametrize(("registry", "name"), CHOICES)

# A line such as `leak = 0.1 [1/s], cap = 2: ...` or `eta0 = eta1 = eta2 = 0: ...`.
NAME, NUMBER = r"[a-z]\w*", r"[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?|inf"
GROUP = rf"(?:{NAME} = )+(?:{NUMBER})(?: \[[^\]]+\])?"
LINE = re.compile(rf"^({GROUP}(?:, {GROUP})*):", re.MULTILINE)


def documented(docstring: str) -> dict[str, float]:
    """The settings that the lines of a docstring begin with, and their defaults."""
    found: dict[str, float] = {}
    for line in LINE.finditer(docstring):
        for group in re.finditer(rf"((?:{NAME} = )+)({NUMBER})", line[1]):
            for name in re.findall(NAME, group[1]):
                assert name not in found, f"{name} is described twice"
                found[name] = float(group[2])
    return found


def module_of(registry: Registry, name: str) -> Any:
    return importlib.import_module(registry.load(name).__module__)


@pytest.mark.parametrize("folder", REGISTRIES)
def test_names_are_those_of_the_modules(folder: str) -> None:
    stems = {path.stem for path in (ALGORITHMS / folder).glob("*.py")} - {"__init__"}
    names = REGISTRIES[folder].names
    assert names == sorted(names)
    assert {name.replace("-", "_") for name in names} == {stem.lstrip("_") for stem in stems}
    assert len(names) == len(stems)


def test_methods_of_the_paper_are_there() -> None:
    assert {"p2smd", "2smd", "astd", "ed-fir"} <= set(DIFFERENTIATORS.names)
    assert {"ls", "rls"} <= set(ESTIMATORS.names)


@every_choice
def test_choice_is_a_frozen_dataclass_of_its_module(registry: Registry, name: str) -> None:
    method = registry.load(name)
    assert method.__name__ == registry.class_name
    assert is_dataclass(method)
    assert method.__dataclass_params__.frozen


@every_choice
def test_description_is_the_docstring(registry: Registry, name: str) -> None:
    described = registry.describe(name)
    assert described
    assert described.split() == (module_of(registry, name).__doc__ or "").split()


MATCHED = {
    Matching.UNFILTERED: r"Matched \(unfiltered\)",
    Matching.EXACT: r"Matched \(exact",
    Matching.SECOND_ORDER: r"Matched \(to second order in the period\)",
    Matching.LINEARISED: "Matched by its linearisation",
    Matching.MEASURED: "Matched by measured delays",
}


@pytest.mark.parametrize("name", DIFFERENTIATORS.names)
def test_a_differentiator_says_its_class_its_delay_and_how_it_is_matched(name: str) -> None:
    classes = {0: "Causal", inf: "Whole record"}
    method, text = DIFFERENTIATORS.load(name), DIFFERENTIATORS.describe(name)
    found = classes.get(method().lag(0.005), "Fixed lag")
    assert re.search(rf"^{found}\b", text, re.MULTILINE)
    assert re.search(r"^Delay: ", text, re.MULTILINE)
    assert re.search(rf"^{MATCHED[method.MATCHING]}", text, re.MULTILINE)


@pytest.mark.parametrize("name", DIFFERENTIATORS.names)
def test_a_differentiator_declares_its_capabilities_on_the_base_class(name: str) -> None:
    """A method that tunes itself has a `fitted` of its own, any other gives itself back."""
    method = DIFFERENTIATORS.load(name)
    assert issubclass(method, Method)
    assert method.MATCHING in Matching
    assert (method.fitted is not Method.fitted) == method.TUNES_ITSELF
    settings = {"noise", "intensity"}
    assert (settings <= {field.name for field in fields(method)}) == method.HAS_LIKELIHOOD


@every_choice
def test_whole_numbers_are_made_once(registry: Registry, name: str) -> None:
    """Settings declared `int` take 4.0, as the command line passes it, and refuse 4.5."""
    method = registry.load(name)
    for field in (field for field in fields(method) if field.type in (int, "int")):
        value = getattr(method(**{field.name: float(field.default)}), field.name)
        assert isinstance(value, int)
        assert value == field.default
        with pytest.raises(UsageFault, match=rf"^{field.name} must be a whole number, not"):
            method(**{field.name: field.default + 0.5})


@every_choice
def test_docstring_gives_every_setting_with_its_default(registry: Registry, name: str) -> None:
    method = registry.load(name)
    settings = names_of(method)
    defaults = {field.name: field.default for field in fields(method) if field.name in settings}
    assert documented(registry.describe(name)) == defaults


@every_choice
def test_method_without_settings_says_so(registry: Registry, name: str) -> None:
    none = not names_of(registry.load(name))
    assert ("No settings." in registry.describe(name)) == none


@every_choice
def test_presets_set_what_there_is_to_set(registry: Registry, name: str) -> None:
    method = registry.load(name)
    settings = {field.name for field in fields(method)}
    for preset, values in getattr(method, "PRESETS", {}).items():
        assert values.keys() <= settings, preset
        made = method(**values)
        assert {key: getattr(made, key) for key in values} == values


def test_documented_settings_are_reported_from_rules_and_prose() -> None:
    """The parser above, on what a docstring may say."""
    text = """A method (paper eq. 1). Rule: eta = 2 L^(1/3), gamma = 1 / (wanted delay): try it.

    leak = 0.1 [1/s], cap = 2, nu_max = 1e-3 [s]: bounds. The printed eta = 1.5 is not meant.
    eta0 = eta1 = 0: nothing.
    eta = 1.5 L^(1/2): a rule again.
    """
    lines = "\n".join(line.strip() for line in text.splitlines())
    expected = {"leak": 0.1, "cap": 2.0, "nu_max": 1e-3, "eta0": 0.0, "eta1": 0.0}
    assert documented(lines) == expected
