"""The process: standard streams, signals and the exit status. Nothing else exits."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import warnings

# Until all is imported, an interrupt ends the process without a traceback.
_interrupted = signal.signal(signal.SIGINT, signal.SIG_DFL)

# numpy starts a thread per processor for a linear algebra that is never large here.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# Arrow's own pool keeps what was freed: 20 MB in a stage, 40 to 60 MB in `identify`, for no speed.
os.environ.setdefault("ARROW_DEFAULT_MEMORY_POOL", "system")

import click  # noqa: E402

from scarid_cli.cli import scarid  # noqa: E402
from scarid_cli.cli.running import chain  # noqa: E402
from scarid_cli.cli.running.terminal import told  # noqa: E402
from scarid_cli.errors import (  # noqa: E402
    BAD_DATA,
    BROKEN_PIPE,
    BUG,
    INTERRUPTED,
    IO_FAILURE,
    USAGE,
    ScaridError,
)
from scarid_cli.io.stop import STOP, Terminated  # noqa: E402
from scarid_cli.printable import printable  # noqa: E402

TERMINATED = 128 + signal.SIGTERM
signal.signal(signal.SIGINT, _interrupted)


def main(arguments: list[str] | None = None) -> int:
    """Run one command line and return its exit status. An error is one line on standard error."""
    words = sys.argv[1:] if arguments is None else arguments
    try:
        # Not `scarid.main`: click turns a broken pipe into exit status 1.
        status = chain.run(scarid, words)
        sys.stdout.flush()
    except click.exceptions.Exit as stop:
        return stop.exit_code
    except click.exceptions.NoArgsIsHelpError as error:
        error.show()
        return USAGE
    except click.UsageError as error:
        path = error.ctx.command_path if error.ctx else "scarid"
        return _reported(path, f"{_usage(error)} (see `{path} --help`)", USAGE)
    except (KeyboardInterrupt, click.Abort):
        return INTERRUPTED
    except Terminated:
        return TERMINATED
    except BrokenPipeError:
        return BROKEN_PIPE
    except chain.StageFailed as failure:
        if "--debug" in words:
            raise failure.error from None
        return _failed(failure.where, failure.error)
    except OSError as error:  # of standard output
        return _failed("scarid", error)
    return status


def _usage(error: click.UsageError) -> str:
    """What is wrong with the command line."""
    if isinstance(error, click.NoSuchOption):
        from scarid_cli.cli.declaring import unknown

        return unknown.told(error)
    return error.format_message().rstrip(".")


def _failed(where: str, error: Exception) -> int:
    if isinstance(error, ScaridError):
        return _reported(where, str(error), error.status)
    if isinstance(error, OSError):
        place = error.filename or "<stdout>"
        return _reported(where, f"{place}: {error.strerror or error}", IO_FAILURE)
    if isinstance(error, MemoryError):
        reason = str(error) or "no more can be had"
        text = f"not enough memory ({reason}); check the options, and the numbers in the input"
        return _reported(where, text, BAD_DATA)
    kind = type(error).__name__
    return _reported(where, f"a bug in scarid ({kind}: {error}); --debug shows where", BUG)


def _reported(where: str, message: str, status: int) -> int:
    # A message of a library may have line breaks.
    line = printable(f"{where}: {' '.join(message.split())}")
    with contextlib.suppress(OSError):  # the status says it as well
        print(told(line), file=sys.stderr, flush=True)  # noqa: T201
    return status


def run() -> None:
    """The entry of the `scarid` command."""
    _mend_streams()
    sys.meta_path.insert(0, WithoutPandas())
    if not sys.warnoptions:  # python -W, PYTHONWARNINGS
        warnings.simplefilter("ignore")  # those of libraries are for programmers
    if instruction := os.environ.get("_SCARID_COMPLETE"):  # the Tab key of a shell
        from scarid_cli.cli.declaring import completing

        completing.answer(scarid, instruction)
        sys.exit(_flushed(0))
    # A command in the background of a script ignores SIGINT, as it should.
    if signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:
        signal.signal(signal.SIGINT, STOP.asked)
    signal.signal(signal.SIGTERM, STOP.asked)
    status = _flushed(main())
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_IGN)  # all is done; what comes now comes too late
    for number, code in (
        (signal.SIGINT, INTERRUPTED),
        (signal.SIGPIPE, BROKEN_PIPE),
        (signal.SIGTERM, TERMINATED),
    ):
        if status == code:
            # End as the signal would have ended us, so that the shell and make see it.
            signal.signal(number, signal.SIG_DFL)
            os.kill(os.getpid(), number)
    sys.exit(status)


class WithoutPandas:
    """Hides two packages that pyarrow would import, which takes up to a third of a second."""

    def find_spec(self, name: str, _path: object = None, _target: object = None) -> None:
        if name in ("pandas", "cloudpickle"):
            raise ModuleNotFoundError(f"scarid uses no {name}", name=name)


def _mend_streams() -> None:
    """Open closed standard streams on a descriptor that fails, so that no file takes its number."""
    for descriptor, flags in ((0, os.O_WRONLY), (1, os.O_RDONLY), (2, os.O_WRONLY)):
        try:
            os.fstat(descriptor)
        except OSError:
            os.open(os.devnull, flags)
    if sys.stdout is None:
        sys.stdout = os.fdopen(1, "w", closefd=False)
    if sys.stderr is None:
        sys.stderr = os.fdopen(2, "w", closefd=False)


def _flushed(status: int) -> int:
    """Flush the outputs here: at the end of the interpreter, a failure would exit with 120."""
    try:
        sys.stdout.flush()
    except BrokenPipeError:
        status = status or BROKEN_PIPE
    except OSError as error:
        status = status or _reported("scarid", f"<stdout>: {error.strerror}", IO_FAILURE)
    with contextlib.suppress(OSError):
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, 1)
        try:
            sys.stderr.flush()
        except OSError:  # the status says it as well
            os.dup2(null, 2)
    return status


if __name__ == "__main__":
    run()
