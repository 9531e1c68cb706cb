"""What is kept of a file, until it changes."""

from __future__ import annotations

from pathlib import Path

import pytest
from unit.arms import URDF

from scarid_cli.algorithms.robots.files import of_file
from scarid_cli.algorithms.robots.reading import load


def test_it_is_read_once_until_the_file_changes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    calls: list[tuple[str, int]] = []

    @of_file
    def text(path: str, times: int) -> str:
        calls.append((path, times))
        return Path(path).read_text() * times

    for folder, content in (("one", "a"), ("two", "b")):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "file").write_text(content)
        monkeypatch.chdir(tmp_path / folder)
        assert text("file", 2) == text("file", 2) == 2 * content
    assert len(calls) == 2
    assert text("file", 3) == "bbb"
    Path("file").write_text("other")
    assert text("file", 2) == "otherother"
    Path("file").unlink()
    assert text("file", 2) == "otherother"  # the robot is in use
    with pytest.raises(FileNotFoundError):
        text("none", 2)


def test_a_urdf_that_was_edited_is_another_robot(tmp_path: Path) -> None:
    """As in a notebook, which stays one process."""
    pytest.importorskip("pinocchio")
    path = tmp_path / "arm.urdf"
    path.write_text(urdf := URDF.replace("TYPE", "revolute"))
    before = load(str(path))
    assert before.body
    links = [own for own, _ in before.body.links]
    path.write_text(urdf.replace(f'"{links[0]}"', '"renamed"'))
    after = load(str(path))
    assert after.body
    assert [own for own, _ in after.body.links] == ["renamed", *links[1:]]
