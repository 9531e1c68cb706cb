"""`validate --residual`: the band, the contacts, and what is refused."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from conftest import Result

Run = Callable[..., Result]
START, END = 7.0, 7.4  # s: something pushes at joint 2


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("residual")


@pytest.fixture
def made(folder: Path, scarid: Run, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An identified robot, another motion of it, and the same one with a push."""
    monkeypatch.chdir(folder)
    if (folder / "pushed.parquet").exists():
        return folder
    for seed, name in ((1, "first"), (2, "second")):
        words = ("trajgen", "-q", "--robot", "scara2", "--seed", seed)
        assert scarid(*words, "then", "simulate", "-q", "-o", f"{name}.parquet").status == 0
    assert scarid("identify", "-q", "first.parquet", "-o", "p.parquet").status == 0
    table = pq.read_table("second.parquet")
    t = table.column("t").to_numpy()
    tau = table.column("tau2").to_numpy() + 0.2 * ((t >= START) & (t < END))
    at = table.column_names.index("tau2")
    table = table.set_column(at, table.schema.field("tau2"), pa.array(tau))
    pq.write_table(table, "pushed.parquet")
    return folder


def judged(scarid: Run, log: str, *more: object) -> tuple[pa.Table, str]:
    result = scarid("validate", "--parameters", "p.parquet", log, "--residual", "r.parquet", *more)
    assert result.status == 0
    return pq.read_table("r.parquet"), result.err.splitlines()[-1]


def test_a_push_is_a_contact_of_its_joint_and_time(made: Path, scarid: Run) -> None:
    table, told = judged(scarid, "pushed.parquet")
    assert "contact: joint 2 from t = 6.98 to 7.4" in told
    t, contact = table.column("t").to_numpy(), table.column("contact").to_numpy()
    inside = (t > START) & (t < END)
    assert np.mean(contact[inside] == 2) > 0.6  # all but rows near reversals
    assert not contact[(t < START - 0.1) | (t > END + 0.1)].any()
    residual = table.column("tau2_residual").to_numpy()
    assert np.mean(residual[inside]) == pytest.approx(0.2, abs=0.02)


@pytest.mark.parametrize("more", [(), ("--observer", 10)], ids=["torques", "observer"])
def test_a_robot_that_nothing_touches_stays_in_its_band(
    made: Path, scarid: Run, more: tuple[object, ...]
) -> None:
    table, told = judged(scarid, "second.parquet", *more)
    assert "no contact: no residual is beyond its band" in told
    assert not table.column("contact").to_numpy().any()
    for joint in (1, 2):
        residual, band = (table.column(f"tau{joint}_{x}").to_numpy() for x in ("residual", "band"))
        assert 0.2 < np.nanmax(np.abs(residual) / band) < 1.0
        assert np.isnan(band).mean() < 0.3


def test_the_observer_finds_the_push_a_time_constant_later(made: Path, scarid: Run) -> None:
    first, second = (
        table.column("t").to_numpy()[np.argmax(table.column("contact").to_numpy() == 2)]
        for table in (judged(scarid, "pushed.parquet", *x)[0] for x in ((), ("--observer", 10)))
    )
    assert 0.0 < second - first < 0.1


def test_fewer_false_alarms_take_a_wider_band(made: Path, scarid: Run) -> None:
    narrow, wide = (
        judged(scarid, "second.parquet", "--false-alarms", rate)[0].column("tau1_band").to_numpy()
        for rate in (10.0, 0.01)
    )
    assert np.all((wide > narrow) | np.isnan(wide))


def test_a_pipe_gives_the_rows_of_the_file(made: Path, scarid: Run) -> None:
    """In batches of any size, with the residuals on standard output."""
    assert scarid("differentiate", "-q", "pushed.parquet", "-o", "motion.parquet").status == 0
    table = pq.read_table("motion.parquet")
    pq.write_table(table, "small.parquet", row_group_size=37)
    for given in ((), ("--observer", 10)):
        words = ("validate", "-q", "--parameters", "p.parquet", *given, "--residual")
        assert scarid(*words, "r.csv", "motion.parquet", "-o", "m.csv").status == 0
        piped = scarid(*words, "-", "small.parquet", "-o", "n.csv")
        assert piped.out == Path("r.csv").read_text("utf-8")
        assert Path("m.csv").read_text("utf-8") == Path("n.csv").read_text("utf-8")


def test_parameters_that_say_nothing_of_their_log_are_refused(made: Path, scarid: Run) -> None:
    assert scarid("identify", "-q", "first.parquet", "-o", "p.csv").status == 0
    for parameters in ("p.csv", "apriori"):
        result = scarid("validate", "--parameters", parameters, "second.parquet",
                        "--residual", "nothing.parquet")  # fmt: skip
        assert result.status == 65
        assert "identify the log again with `scarid identify -o FILE.parquet`" in result.err
        assert not Path("nothing.parquet").exists()


@pytest.mark.parametrize("option", ["--observer", "--false-alarms"])
def test_an_option_of_the_residual_alone_is_refused(made: Path, scarid: Run, option: str) -> None:
    result = scarid("validate", "--parameters", "p.parquet", "second.parquet", option, 5)
    assert result.status == 2
    assert f"{option} belongs to --residual" in result.err
