"""What a configuration means: robots, logs in order, options."""

from __future__ import annotations

from pathlib import Path

import pytest
from steps.plan import PIPE, PlanError, read


def plan_of(text: str, folder: Path, monkeypatch: pytest.MonkeyPatch, *files: str) -> object:
    """The plan of a configuration in a folder with these files."""
    for name in files:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).touch()
    (folder / "fleet.toml").write_text(text)
    monkeypatch.chdir(folder)
    return read("fleet.toml")


LEFT = '[robots.left]\nrobot = "scara2"\nlogs = "logs/**/*.*"\n'


@pytest.mark.parametrize(
    ("files", "names", "dates"),
    [
        (["run10.csv", "run2.csv"], ["run2", "run10"], [None, None]),
        (["b/1.csv", "a/2.csv"], ["a/2", "b/1"], [None, None]),
        (["x.csv.gz", "y.2.parquet"], ["x", "y.2"], [None, None]),
        (
            ["left_2026-03-02.csv", "left_20260301T0905.csv", "old.csv"],
            ["old", "left_20260301T0905", "left_2026-03-02"],
            [None, "2026-03-01T09:05:00", "2026-03-02"],
        ),
        (["2026-13-45.csv", "2026-2-3/a.csv"], ["2026-2-3/a", "2026-13-45"], [None, None]),
    ],
)  # fmt: skip
def test_logs_are_ordered_by_date_and_then_by_name(
    files: list[str],
    names: list[str],
    dates: list[str | None],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    plan = plan_of(LEFT, tmp_path, monkeypatch, *(f"logs/{name}" for name in files))
    logs = plan.robots[0].logs
    assert [log.name for log in logs] == names
    assert [log.date for log in logs] == dates
    assert [log.order for log in logs] == [*range(1, len(files) + 1)]


def test_options_of_a_robot_take_the_place_of_common_ones(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = (
        'group = 2\n[pipe]\nresample = "--rate 100"\nvalidate = "--all-rows"\n'
        + LEFT
        + '[robots.left.pipe]\nresample = "--rate 250"\ndifferentiate = "--method kalman"\n'
    )
    plan = plan_of(text, tmp_path, monkeypatch, "logs/a.csv", "logs/b.csv", "logs/c.csv")
    robot = plan.robots[0]
    assert robot.pipe == {
        **PIPE,
        "resample": "--rate 250",
        "validate": "--all-rows",
        "differentiate": "--method kalman",
    }
    assert not robot.tuned
    assert plan.groups(robot) == ["0001", "0002"]
    assert [log.name for log in plan.logs(robot, "0002")] == ["c"]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("out = 3 4", "fleet.toml: Expected newline"),
        ('out = "x"', "no robots"),
        ("colour = 1\n" + LEFT, "unknown key 'colour'; there are group, out, pages, pipe, robots"),
        ("group = 0\n" + LEFT, "group = 0: give the number of logs of a job"),
        ('pages = "many"\n' + LEFT, "write one of all, needed, none"),
        (LEFT + 'rate = "9"', "robots.left: unknown key 'rate'"),
        (LEFT.replace("left", '"a b"'), "a name has letters, digits"),
        (LEFT.replace('robot = "scara2"', ""), "robot = NAME or FILE is missing"),
        (LEFT.replace("logs =", "pipe = {}\n#"), "logs = [PATTERN, ...] is missing"),
        (LEFT.replace("logs/", "elsewhere/"), "no file matches elsewhere/**/*.*"),
        ("[pipe]\nfilter = 'x'\n" + LEFT, "pipe: unknown key 'filter'"),
        ("[pipe]\nidentify = ['x']\n" + LEFT, "the options of identify are one text"),
        (LEFT.replace("logs/**/*.*", "*/[ab].*"), "would both be the log a"),
    ],
)
def test_a_wrong_configuration_is_one_line(
    text: str, said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(PlanError) as error:
        plan_of(text, tmp_path, monkeypatch, "logs/a.csv", "logs/a.parquet")
    assert said in str(error.value)
    assert "\n" not in str(error.value)
