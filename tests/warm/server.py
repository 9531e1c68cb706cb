"""A process that has imported what scarid needs, and forks for each `scarid` of a shell.

    python server.py SOCKET < PIPE

Most of the time of a short command goes into its imports, which every command of every test would
repeat. `client.py` stands for scarid in the shell; it hands its words, its directory, its variables
and its standard streams over, and ends as the fork ends. The server ends with its standard input.
"""

from __future__ import annotations

import gc
import importlib
import marshal
import os
import pkgutil
import selectors
import signal
import socket
import sys

STREAMS = 3
NEEDED = (
    "cvxpy",
    "matplotlib.pyplot",
    "pinocchio",
    "scipy.linalg",
    "scipy.optimize",
    "scipy.signal",
)


def load() -> None:
    """Import the modules of scarid, and packages that these import when they need them."""
    from scarid_cli.__main__ import WithoutPandas

    sys.meta_path.insert(0, WithoutPandas())
    package = importlib.import_module("scarid_cli")
    modules = pkgutil.walk_packages(package.__path__, "scarid_cli.")
    for name in (*(module.name for module in modules), *NEEDED):
        try:
            importlib.import_module(name)
        except ModuleNotFoundError:
            continue  # of an extra that is not installed
    gc.freeze()


def run(request: bytes, streams: list[int]) -> None:
    """Become the command that was asked for."""
    from scarid_cli import __main__

    words, folder, variables = marshal.loads(request)
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(variables)
    for number, descriptor in enumerate(streams):
        os.dup2(descriptor, number)
        os.close(descriptor)
    sys.stdin, sys.stdout, sys.stderr = (
        open(number, mode, encoding="utf-8", closefd=False)  # noqa: SIM115
        for number, mode in enumerate(("r", "w", "w"))
    )
    sys.argv = ["scarid", *words]
    __main__.run()


def forked(request: bytes, streams: list[int]) -> int:
    """The number of a process that becomes the command."""
    pid = os.fork()
    if pid:
        return pid
    status = 1
    try:
        signal.set_wakeup_fd(-1)
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        run(request, streams)
    except SystemExit as end:
        status = int(end.code or 0)
    except BaseException:
        sys.excepthook(*sys.exc_info())
    finally:
        sys.stderr.flush()
        os._exit(status)


def received(connection: socket.socket) -> tuple[bytes, list[int]]:
    """What a client asks for, and its standard streams."""
    request, streams, _, _ = socket.recv_fds(connection, 1 << 16, STREAMS)
    while more := connection.recv(1 << 16):
        request += more
    return request, streams


def serve(listener: socket.socket) -> None:
    """Fork for each client, and tell it how the command ended, until standard input ends."""
    ended, woken = socket.socketpair()
    for end in (ended, woken):
        end.settimeout(0)
    signal.signal(signal.SIGCHLD, lambda *_: None)
    signal.set_wakeup_fd(woken.fileno())
    clients: dict[int, socket.socket] = {}
    selector = selectors.DefaultSelector()
    for source in (listener, ended, sys.stdin):
        selector.register(source, selectors.EVENT_READ)
    while True:
        ready = [key.fileobj for key, _ in selector.select()]
        if listener in ready:
            connection, _ = listener.accept()
            request, streams = received(connection)
            clients[forked(request, streams)] = connection
            for descriptor in streams:
                os.close(descriptor)
        if ended in ready:
            ended.recv(1 << 12)
            report(clients)
        if sys.stdin in ready:
            return


def report(clients: dict[int, socket.socket]) -> None:
    """Tell the clients of the commands that have ended the status of these."""
    while clients:
        pid, status = os.waitpid(-1, os.WNOHANG)
        if not pid:
            return
        with clients.pop(pid) as connection:
            connection.sendall(str(os.waitstatus_to_exitcode(status)).encode())


if __name__ == "__main__":
    load()
    with socket.socket(socket.AF_UNIX) as opened:
        opened.bind(sys.argv[1])
        opened.listen(64)
        print("ready", flush=True)
        serve(opened)
