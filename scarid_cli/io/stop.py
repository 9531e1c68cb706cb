"""The end of a live input: the first SIGINT or SIGTERM ends the input, the second one the run.

A person stops a pipe that runs beside a robot with Ctrl-C, a script with `kill`. What has arrived
is then worked up, written and judged, as at the end of the input. A run whose input is a file, or
of which no byte has arrived, has nothing to keep, and stops at once.

The handler sets a mark and wakes the reader, which waits for bytes or for the mark: an exception
that is raised wherever the program happens to be can be lost, as in the callback of a weak
reference, or leave a batch half done.
"""

from __future__ import annotations

import contextlib
import os
import select
import signal
import time
from collections.abc import Iterator, Sequence
from types import FrameType

GRACE = 1.0  # s: for what is on its way, where the writer does not end by itself
TICK = 0.05  # s between looks at the clock in this time


class Terminated(BaseException):
    """The process was asked to end; it cleans up as after any failure."""


class Stop:
    """What the signals of this process have asked for; `number` is the first one, 0 if none came.

    `live` says whether bytes of an input that is no file have arrived, which ends at `number`.
    """

    def __init__(self) -> None:
        self.number = 0
        self.live = False
        self._at = 0.0
        self._lost: BaseException | None = None
        self._postponed = False
        self._wakes: tuple[int, int] | None = None

    def asked(self, number: int, _frame: FrameType | None) -> None:
        """The handler of both signals."""
        if self.live and not self.number:
            self.number, self._at = number, time.monotonic()
            if self._wakes:
                with contextlib.suppress(OSError):
                    os.write(self._wakes[1], b"x")
            return
        self._lost = KeyboardInterrupt() if number == signal.SIGINT else Terminated()
        if not self._postponed:
            raise self._lost

    @contextlib.contextmanager
    def postponed(self) -> Iterator[None]:
        """Stop only after this block, which opens a file and notes it, or puts files in places."""
        before, self._postponed = self._postponed, True
        try:
            yield
        finally:
            self._postponed = before
        if not before:
            self.require_not_lost()

    def require_not_lost(self) -> None:
        """Stop now if an earlier exception of the handler came to nothing."""
        if self._lost:
            raise self._lost

    def readable(self, fd: int) -> bool:
        """Wait until there is something to read, or the end of it; False once the input is over."""
        waker = self._waker()
        poll = select.poll()
        poll.register(fd, select.POLLIN)
        poll.register(waker, select.POLLIN)
        while not self.over:
            found = dict(poll.poll(1e3 * TICK if self.number else None))
            if fd in found:
                return True
            if found:
                os.read(waker, 64)
        return False

    def wait(self, seconds: float | None, fds: Sequence[int] = ()) -> list[int]:
        """Those of the descriptors that can be read, after so long [s] at most; None: for ever.

        A signal ends the wait: what can be read then has been on its way.
        """
        waker = self._waker()
        limit = 0.0 if self.number else seconds
        return [fd for fd in select.select([*fds, waker], [], [], limit)[0] if fd != waker]

    def _waker(self) -> int:
        """The descriptor that a signal makes readable."""
        if self._wakes is None:
            self._wakes = os.pipe()
            for end in self._wakes:
                os.set_blocking(end, False)
        return self._wakes[0]

    @property
    def over(self) -> bool:
        """Whether the input has ended by a signal, and what was on its way has arrived."""
        return bool(self.number) and time.monotonic() - self._at > GRACE

    @property
    def told(self) -> str:
        """What is said of a result whose input was ended by a signal; empty if it was not."""
        if not self.number:
            return ""
        name = signal.Signals(self.number).name
        return f"{name} ended the input: the result is of what had arrived"


STOP = Stop()
