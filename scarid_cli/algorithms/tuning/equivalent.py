"""The settings with which a differentiator has the bandwidth of a chosen cut-off."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import pi
from typing import Any, TypeVar

from scarid_cli.algorithms.differentiators.kalman_lag import Differentiator as FixedLag
from scarid_cli.algorithms.differentiators.zero_phase import Differentiator as ZeroPhase
from scarid_cli.algorithms.filters.kalman_method import KalmanMethod
from scarid_cli.algorithms.processes.bandwidth import bandwidth_of
from scarid_cli.algorithms.processes.method import Method
from scarid_cli.algorithms.tuning.lowpassed import ORDER, TWO_SIDED
from scarid_cli.errors import UsageFault

DOUBLINGS = 14  # of the default settings, upwards or downwards, until the bandwidth is passed
HALVINGS = 30
WAIT = 4.0  # time constants that a smoother of fixed lag waits

K = TypeVar("K", bound=KalmanMethod)


def chain(method: K, noise: float, cutoff: float, h: float) -> K:
    """A Kalman method with the poles of a Butterworth filter of order 4 at the cut-off [Hz].

    The steady filter of n integrators behind white noise of density S, measured with the density
    noise^2 h, has its poles where 1 + S / (noise^2 h) / (-s^2)^n = 0 (Anderson and Moore, Optimal
    Filtering, 1979, section 4.5). Its smoother is then the filter run forwards and backwards.
    noise [rad or m], h [s]. The settings have few digits, so that they can be typed.
    """
    noise = typed(noise)
    rate = 2.0 * pi * cutoff
    settings: dict[str, Any] = {
        "noise": noise,
        "intensity": typed(noise**2 * h * rate ** (2 * ORDER)),
        "states": ORDER,
        "damping": 0.0,
        "frequency": 0.0,
    }
    if isinstance(method, FixedLag):
        settings["delay"] = typed(max(WAIT / rate, 2.0 * h))
    return replace(method, **settings)


def equivalent(method: Method, noise: float, cutoff: float, h: float) -> Method | None:
    """The method with the bandwidth of the zero-phase, or if it is causal the causal, Butterworth.

    None if it has no bandwidth, because it is not linear or has no settings.
    """
    if isinstance(method, KalmanMethod):
        return chain(method, noise, cutoff, h)
    if isinstance(method, ZeroPhase):
        return replace(method, cutoff=typed(cutoff), order=ORDER)
    if not method.TUNED or bandwidth_of(method, h) is None:
        return None
    return scaled(method, cutoff if method.lag(h) == 0 else TWO_SIDED * cutoff, h)


def scaled(method: Any, bandwidth: float, h: float) -> Method:
    """The method with its settings scaled, all by the same factor, to this bandwidth [Hz]."""

    def at(factor: float) -> Any:
        settings: dict[str, Any] = {
            n: r.scaled(getattr(method, n), factor) for n, r in method.TUNED.items()
        }
        settings = {n: x if method.TUNED[n].step else typed(x) for n, x in settings.items()}
        return replace(method, **settings)

    def too_wide(factor: float) -> bool:
        try:
            return (bandwidth_of(at(factor), h) or 0.0) > bandwidth
        except UsageFault:
            return factor > 1.0  # such as a window of too few samples

    found: Method = at(_crossing(too_wide))
    return found


def _crossing(above: Callable[[float], bool]) -> float:
    """The factor from which on a property holds, by doubling or halving 1 and then by bisection."""
    high = low = 1.0
    for _ in range(DOUBLINGS):
        if above(high):
            break
        low, high = high, 2.0 * high
    for _ in range(DOUBLINGS):
        if not above(low):
            break
        low, high = 0.5 * low, low
    for _ in range(HALVINGS):
        middle = (low * high) ** 0.5
        low, high = (low, middle) if above(middle) else (middle, high)
    return low


def typed(value: float) -> float:
    """The value with four significant digits."""
    return float(f"{value:.4g}")
