"""A scarid that forks, as most shells of tests have it, is like one that users start."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from conftest import Result

Shell = Callable[..., Result]


@pytest.mark.parametrize(
    "line",
    [
        "scarid differentiate $SAMPLES/scara2.csv | scarid identify",
        "scarid filter < $SAMPLES/scara2.csv | wc -l",
        "scarid identify --estimator none $SAMPLES/scara2.csv",
        "printf 't,q1\\n0,1\\n1,x\\n' | scarid filter",
        "scarid trajgen > /dev/full",
        "scarid trajgen -q --duration 2000 | head -1; echo ${PIPESTATUS[0]}",
        "cd /; NO_COLOR= SCARID_FORMAT=json scarid convert $SAMPLES/scara2.csv; echo $?",
    ],
)
def test_a_fork_prints_and_ends_as_scarid_does(line: str, shell: Shell, users_shell: Shell) -> None:
    assert shell(line) == users_shell(line)


def test_a_fork_is_in_the_folder_of_its_shell(shell: Shell) -> None:
    result = shell("mkdir a && cd a && scarid trajgen -q --duration 2 -o t.csv && ls")
    assert (result.status, result.out) == (0, "t.csv\n")
