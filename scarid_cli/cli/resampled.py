"""Logs with a sensor that is slower than the rows, resampled before `identify` takes them."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from scarid_cli.cli.job import Job
    from scarid_cli.io.table import Table


class Resampled:
    """Measurements as `scarid resample` returns them, where a slower sensor makes that necessary.

    `rates` are the rates [Hz] as typed, by the names of the files that were resampled.
    """

    def __init__(self, job: Job) -> None:
        self.rates: dict[str, str] = {}
        self._job = job

    def table(self, file: str, measurement: Table) -> Table:
        """The measurement at its own rate, without steps between the readings of slower sensors."""
        from scarid_cli.stages.resample import resample
        from scarid_cli.stages.slower import slower_groups

        slower, measurement = slower_groups(measurement)
        if not slower:
            return measurement
        self.rates[file] = f"{1.0 / measurement.period:.12g}"
        for group in slower:
            self._job.notes.append(
                f"{measurement.name}: {group.name} are new every {1e3 * group.interval:.3g} ms "
                f"only, rows every {1e3 * measurement.period:.3g} ms: interpolated as `scarid "
                "resample` does"
            )
        return resample(measurement, float(self.rates[file]))
