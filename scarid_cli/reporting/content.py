"""What a report says: its sections and their order, the same for every way of showing them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from scarid_cli.reporting import published, torques
from scarid_cli.reporting.estimates import changes, constants, estimates, fit, said_of, verdicts
from scarid_cli.reporting.evolution import evolution
from scarid_cli.reporting.gains import gains
from scarid_cli.reporting.kinds import (
    OF_NO_METHOD,
    Hung,
    JointGains,
    Loads,
    Measurement,
    Metrics,
    MotionEstimate,
    Parameters,
    Prediction,
    Result,
    Trace,
)
from scarid_cli.reporting.loads import loads, payloads
from scarid_cli.reporting.parts import Section
from scarid_cli.reporting.signals import compared_with, logs, soft_sensors
from scarid_cli.reporting.wording import experiment_of, grouped, of_kind


def sections(results: Sequence[Result], values: published.Values | None = None) -> list[Section]:
    """Everything that these results have to say, with published values beside them."""
    labels = (r.name.label for r in results if not isinstance(r, OF_NO_METHOD))
    colours = {name: i for i, name in enumerate(dict.fromkeys(labels))}
    results = published.beside(results, values or {})
    return [
        *verdicts(of_kind(results, Parameters)),
        *changes(said_of(results)),
        *published.settings(results, values or {}),
        *(logs(group) for group in grouped(of_kind(results, Measurement), experiment_of)),
        *(
            soft_sensors(group, colours)
            for group in grouped(of_kind(results, MotionEstimate), compared_with)
        ),
        *_of_estimates(results, colours),
        *_of_torques(results, colours),
        *gains(of_kind(results, JointGains)),
        *payloads(of_kind(results, Hung)),
        *loads(of_kind(results, Loads)),
    ]


def _of_estimates(results: Sequence[Result], colours: dict[str, int]) -> Iterator[Section]:
    """Final estimates, then running ones; a table holds those of the same parameters."""
    for group in grouped(of_kind(results, Parameters), _same_parameters):
        yield estimates(group, colours)
        yield from fit(group)
        yield from constants(group)
    for running in grouped(of_kind(results, Trace), _same_parameters):
        yield evolution(running, colours)


def _same_parameters(result: Parameters | Trace) -> tuple[tuple[str, ...], str | None, str]:
    return result.names, result.robot_name, result.name.experiment


def _of_torques(results: Sequence[Result], colours: dict[str, int]) -> Iterator[Section]:
    yield from torques.experiments(of_kind(results, Metrics))
    predicted = [r for r in results if isinstance(r, (Metrics, Prediction))]
    for group in grouped(predicted, lambda r: (r.joints, r.name.experiment)):
        yield torques.experiment(group, colours)
