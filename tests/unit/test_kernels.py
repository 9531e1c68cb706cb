"""Every kernel runs compiled, and gives the bits of its interpreted source."""

from __future__ import annotations

import importlib
import itertools
import re
from collections.abc import Callable, Iterator
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from speed import FOLDER, interpreted
from unit.kernel_cases import CASES, COUPLING, LINK, Arguments, leaves

NAMES = sorted(path.stem for path in FOLDER.glob("*.pxd"))


def compiled(name: str) -> ModuleType:
    return importlib.import_module(f"scarid_cli.kernels.{name}")


@pytest.mark.parametrize("name", NAMES)
def test_kernel_is_compiled(name: str) -> None:
    file = compiled(name).__file__ or ""
    assert file.endswith(".so"), (
        f"kernel {name} runs interpreted, from {file}: python setup.py build_ext --inplace"
    )


def test_every_public_function_is_compared_with_its_source() -> None:
    sources = {path.stem for path in FOLDER.glob("*.py")} - {"__init__"}
    assert sources == set(NAMES), "a kernel without its .pxd is not compiled"
    public = {
        (name, function)
        for name in NAMES
        for function in re.findall(r"^cpdef .*?(\w+)\(", (FOLDER / f"{name}.pxd").read_text(), re.M)
    }
    assert {(kernel, function) for kernel, function, _ in CASES.values()} == public


def bits(x: Any) -> np.ndarray:
    """The bits, which distinguish -0 from 0."""
    return np.asarray(x, dtype=np.float64).view(np.int64)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("case", CASES)
def test_compiled_and_interpreted_bits_are_equal(case: str, seed: int) -> None:
    kernel, function, arguments = CASES[case]
    ours, theirs = (arguments(np.random.default_rng(seed)) for _ in range(2))
    fast = getattr(compiled(kernel), function)(*ours)
    slow = getattr(interpreted(kernel), function)(*theirs)
    assert fast == slow
    for mine, other in zip(leaves(ours), leaves(theirs), strict=True):
        np.testing.assert_array_equal(bits(mine), bits(other))


@pytest.mark.parametrize("case", ["arm", "arm, perfect encoder"])
def test_arm_case_does_slide_and_stick(case: str) -> None:
    """Else the comparison of bits above would leave out half of the kernel."""
    arguments = CASES[case][2](np.random.default_rng(0))
    assert compiled("arm").run(*arguments) == len(arguments[0])
    still = arguments[2][:, 6:8] == 0.0
    assert still.any(axis=0).all()
    assert not still.all(axis=0).any()


def wrong_lengths() -> Iterator[Any]:
    """Each array of each kernel, along each of its axes, one too short or too long."""
    variants = {"levant, Euler", "kalman, lagged"}  # whose records and outputs may differ in length
    one = {(kernel, function): case for case, (kernel, function, _) in CASES.items()}
    for case in sorted(set(one.values()) - variants):
        for index, argument in enumerate(leaves(CASES[case][2](np.random.default_rng(0)))):
            for axis in range(np.ndim(argument)):
                if axis == 0 and (argument is COUPLING or np.shape(argument)[1:] == (LINK,)):
                    continue  # an arm may have any number of couplings and of links
                for change in (-1, 1):
                    label = f"{case} argument {index} axis {axis} {change:+d}"
                    yield pytest.param(case, index, axis, change, id=label)


def resized(array: np.ndarray, axis: int, change: int) -> np.ndarray:
    """Zeros of the array's shape but for one axis, within a larger piece of memory.

    A kernel that misses the wrong length reads and writes beyond it, but harms nothing.
    """
    shape = list(array.shape)
    shape[axis] += change
    memory = np.zeros(2 * array.size + 64)
    return memory[: int(np.prod(shape))].reshape(shape)


def replaced(arguments: Arguments, index: int, change: Callable[[Any], Any]) -> Arguments:
    """The arguments with one of their leaves changed."""
    numbers = itertools.count()

    def one(x: Any) -> Any:
        return change(x) if next(numbers) == index else x

    return [
        tuple(map(one, group)) if isinstance(group, tuple) else one(group) for group in arguments
    ]


@pytest.mark.parametrize("load_kernel", [compiled, interpreted])
@pytest.mark.parametrize(("case", "index", "axis", "change"), list(wrong_lengths()))
def test_wrong_length_is_refused(
    case: str, index: int, axis: int, change: int, load_kernel: Callable[[str], ModuleType]
) -> None:
    kernel, function, make = CASES[case]
    arguments = replaced(
        make(np.random.default_rng(0)), index, lambda array: resized(array, axis, change)
    )
    with pytest.raises(ValueError, match=r"lengths|numbers|sizes"):
        getattr(load_kernel(kernel), function)(*arguments)
