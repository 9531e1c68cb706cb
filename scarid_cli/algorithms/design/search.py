"""Random starts in parallel processes, and the refinement of the best ones."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from math import ceil
from multiprocessing import get_context

from scarid_cli.algorithms.design.problem import Problem, Wanted
from scarid_cli.algorithms.trajectories.curve import Curve
from scarid_cli.errors import UsageFault

REFINED_SHARE = 10  # one of so many starts is refined
THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")


@dataclass(frozen=True)
class Best:
    """The best curve of a number of starts."""

    curve: Curve
    starts: int


Found = tuple[float, Curve]
_problem: list[Problem] = []  # of this process


def search(
    wanted: Wanted, seed: int, starts: int | None, budget: float, progress: Callable[[], object]
) -> Best:
    """The best curve of some starts, or of as many as fit into the budget [s].

    It depends on the wish, the seed and the number of starts alone.
    """
    began = time.monotonic()
    with _one_thread_each(), _started_well(), _workers(wanted) as pool:
        found = _started(pool, seed, starts, began + budget, progress)
        best = sorted(found, key=_value)[: ceil(len(found) / REFINED_SHARE)]
        refined = list(pool.map(_refine, [curve for _, curve in best]))
    return Best(min(refined, key=_value)[1], len(found))


def _value(found: Found) -> float:
    return found[0]


def _started(
    pool: ProcessPoolExecutor,
    seed: int,
    starts: int | None,
    end: float,
    progress: Callable[[], object],
) -> list[Found]:
    """The curves of all starts, in their order."""
    running: set[Future[Found]] = set()
    all_of_them: list[Future[Found]] = []
    width = workers()
    began = time.monotonic()

    def another() -> bool:
        count = len(all_of_them)
        if starts is not None:
            return count < starts
        done = count - len(running)
        each = (time.monotonic() - began) / done if done else 0.0
        rounds = 1.0 + ceil(ceil((count + 1) / REFINED_SHARE) / width)
        return count < width or time.monotonic() + rounds * width * each < end

    while running or another():
        while len(running) < width and another():
            future = pool.submit(_start, seed, len(all_of_them))
            running.add(future)
            all_of_them.append(future)
        done, running = wait(running, return_when=FIRST_COMPLETED)
        for _ in done:
            progress()
    return [future.result() for future in all_of_them]


def workers() -> int:
    """The processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@contextmanager
def _workers(wanted: Wanted) -> Iterator[ProcessPoolExecutor]:
    pool = ProcessPoolExecutor(
        workers(), mp_context=get_context("spawn"), initializer=_prepare, initargs=(wanted,)
    )
    try:
        yield pool
    finally:
        pool.shutdown(cancel_futures=True)


@contextmanager
def _started_well() -> Iterator[None]:
    """Say what to do where the processes ended at once, as those of a script without a guard do."""
    try:
        yield
    except BrokenProcessPool:
        raise UsageFault(
            "the processes of the search ended; a script of Python begins them only under "
            '`if __name__ == "__main__":`'
        ) from None


@contextmanager
def _one_thread_each() -> Iterator[None]:
    """Processes that begin here compute with one thread each: as fast, and always the same bits."""
    before = {name: os.environ.get(name) for name in THREADS}
    os.environ.update(dict.fromkeys(THREADS, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


def _prepare(wanted: Wanted) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the main process ends the others
    _problem.append(Problem.of(wanted))


def _start(seed: int, start: int) -> Found:
    curve = _problem[0].optimised(seed, start)
    return _problem[0].value(curve), curve


def _refine(curve: Curve) -> Found:
    better = _problem[0].refined(curve)
    return _problem[0].value(better), better
