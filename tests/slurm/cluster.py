"""A real Slurm on this machine alone: munged, slurmctld and slurmd in a folder of their own.

They listen on the loopback interface, at ports that are free, and are ended by their process ids.
"""

from __future__ import annotations

import contextlib
import getpass
import os
import secrets
import shutil
import socket
import subprocess
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "srun", "squeue", "sinfo", "scancel")
WAIT = 60.0  # s
CONFIGURATION = """
ClusterName=one
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller}
SlurmdPort={node}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CommunicationParameters=NoCtldInAddrAny,NoInAddrAny
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
MinJobAge=300
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
JobCompType=jobcomp/filetxt
JobCompLoc={folder}/jobs.log
NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus} RealMemory={memory} State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def missing() -> str:
    """Why there is no Slurm here; empty if there is one."""
    absent = [name for name in PROGRAMS if not _program(name)]
    if absent:
        return f"no {', '.join(absent)} here (Debian: apt-get install slurm-wlm munge)"
    return ""


def _program(name: str) -> str | None:
    return shutil.which(name, path=f"{os.environ['PATH']}{os.pathsep}/usr/sbin")


@dataclass(frozen=True)
class Cluster:
    """A running cluster: its folder, and the environment in which commands find it."""

    folder: Path
    environment: dict[str, str]

    def run(self, *words: str) -> str:
        """What a command of Slurm prints."""
        done = subprocess.run(
            words, env=self.environment, capture_output=True, text=True, check=True, timeout=WAIT
        )
        return done.stdout

    def finished(self) -> list[str]:
        """The accounting log: a line for each job that has ended."""
        log = self.folder / "jobs.log"
        return log.read_text().splitlines() if log.exists() else []


@contextlib.contextmanager
def cluster(folder: Path) -> Iterator[Cluster]:
    """Start Slurm in a folder, and end it."""
    for name in ("state", "spool"):
        (folder / name).mkdir()
    key = folder / "munge.key"
    key.touch(0o600)
    key.write_bytes(secrets.token_bytes(1024))
    config = folder / "slurm.conf"
    values = {"host": socket.gethostname().split(".")[0], "user": getpass.getuser()}
    controller, node = _ports(2)
    values["memory"] = str(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") // 2**20 // 2)
    text = CONFIGURATION.format(
        folder=folder, controller=controller, node=node, cpus=os.cpu_count(), **values
    )
    config.write_text(text.lstrip())
    path = f"{_bin(folder, config)}{os.pathsep}{os.environ['PATH']}"
    environment = {**os.environ, "SLURM_CONF": str(config), "PATH": path}
    found = Cluster(folder, environment)
    with contextlib.ExitStack() as stack:
        stack.enter_context(_daemon(folder, environment, "munged", *_munge(folder)))
        _until((folder / "munge.socket").exists, "munged")
        stack.enter_context(_daemon(folder, environment, "slurmctld", "-D", "-f", str(config)))
        stack.enter_context(_daemon(folder, environment, "slurmd", "-D", "-f", str(config)))
        _until(lambda: "idle" in _said(found, "sinfo", "-h", "-o", "%T"), "slurmd")
        yield found
        _said(found, "scancel", "--user", values["user"])
        _until(lambda: not _said(found, "squeue", "-h"), "the last job")


def _bin(folder: Path, config: Path) -> Path:
    """A folder with an srun that finds the configuration.

    Within a job, Snakemake's plugin calls srun without the variables of Slurm, SLURM_CONF included.
    """
    place = folder / "bin" / "srun"
    place.parent.mkdir()
    place.write_text(f'#!/bin/sh\nSLURM_CONF={config} exec {_program("srun")} "$@"\n')
    place.chmod(0o755)
    return place.parent


def _munge(folder: Path) -> list[str]:
    names = {"socket": "socket", "key-file": "key", "pid-file": "pid", "log-file": "log"}
    places = [f"--{option}={folder}/munge.{name}" for option, name in names.items()]
    return ["--foreground", "--force", f"--seed-file={folder}/munge.seed", *places]


def _ports(count: int) -> list[int]:
    """Ports of the loopback interface that nobody uses."""
    sockets = [socket.socket() for _ in range(count)]
    for one in sockets:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


@contextlib.contextmanager
def _daemon(folder: Path, environment: dict[str, str], name: str, *words: str) -> Iterator[None]:
    program = _program(name)
    assert program
    with (folder / f"{name}.out").open("wb") as out:
        process = subprocess.Popen([program, *words], env=environment, stdout=out, stderr=out)
        try:
            yield
        finally:
            process.terminate()
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def _said(found: Cluster, *words: str) -> str:
    """What a command prints, nothing while it fails."""
    try:
        return found.run(*words)
    except (subprocess.CalledProcessError, subprocess.TimeoutExpired):
        return ""


def _until(ready: Callable[[], object], what: str) -> None:
    deadline = time.monotonic() + WAIT
    while not ready():
        if time.monotonic() > deadline:
            raise TimeoutError(f"{what} is not ready after {WAIT:g} s")
        time.sleep(0.2)
