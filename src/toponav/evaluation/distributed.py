"""A crew of Ray actors, on this machine or on a cluster. The only module that knows Ray."""

from __future__ import annotations

import contextlib
import os
import socket
import sys
from typing import Any

from toponav.errors import InputError, MissingExtraError, TopoNavError
from toponav.evaluation.crew import Outcome, WorkerFactory, attempt
from toponav.evaluation.tasks import Task

CONNECT_TIMEOUT_S = 5.0
"""How long a cluster's head may take to answer before it counts as absent."""

DEFAULT_PORT = 6379


class RayCrew:
    """Workers in processes of their own; one that dies is replaced."""

    def __init__(self, make_worker: WorkerFactory, size: int, address: str | None = None) -> None:
        """Start or join Ray and make the workers.

        Args:
            make_worker: Makes a worker; it is sent to the processes.
            size: How many workers.
            address: HOST:PORT of a running cluster's head; None starts Ray on this machine.

        Raises:
            MissingExtraError: Ray is not installed.
            InputError: There is no cluster at the address, or it has too few CPUs.
        """
        self._ray = _import_ray()
        self.size = size
        self._running: dict[Any, int] = {}
        with contextlib.ExitStack() as held:
            # Ray tells of workers that died on stdout, which is for the command's result alone.
            held.enter_context(contextlib.redirect_stdout(sys.stderr))
            if not self._ray.is_initialized():
                held.callback(self._ray.shutdown)
                _join(self._ray, size, address)
            _check_room(self._ray, size)
            self._held = held.pop_all()
        self._actor = self._ray.remote(max_restarts=0)(_Actor)
        self._make_worker = self._ray.put(make_worker)
        # One CPU each, also for its threads: they would compete with the other workers.
        self._actors = [self._hire(cpus=1) for _ in range(size)]

    def start(self, worker: int, task: Task) -> None:
        """Send a task to a worker."""
        self._running[self._actors[worker].attempt.remote(task)] = worker

    def wait(self) -> tuple[int, Outcome | None]:
        """The next worker to finish; one that died is replaced and has no outcome.

        Raises:
            TopoNavError: A worker cannot even be made, so that no episode could be run.
        """
        [done], _ = self._ray.wait(list(self._running), num_returns=1)
        worker = self._running.pop(done)
        errors = self._ray.exceptions
        try:
            return worker, self._ray.get(done)
        except (errors.RayActorError, errors.OutOfMemoryError) as error:
            if getattr(error, "actor_init_failed", False):
                raise TopoNavError(
                    f"no worker can start ({_last_line(error)}); install the same toponav on every "
                    "machine, then go on with --resume"
                ) from error
            self._ray.kill(self._actors[worker])  # it may only be out of reach
            # If its machine is gone, the new one shares a CPU rather than wait for one for ever.
            self._actors[worker] = self._hire(cpus=0)
            return worker, None

    def close(self) -> None:
        """End the workers, and Ray where it was started here."""
        for actor in self._actors:
            self._ray.kill(actor)
        self._held.close()

    def _hire(self, cpus: int) -> Any:
        return self._actor.options(num_cpus=cpus).remote(self._make_worker)


def _last_line(error: Exception) -> str:
    """What a process raised, without its traceback."""
    return str(error).strip().splitlines()[-1].strip()


class _Actor:
    """Holds one worker in its process."""

    def __init__(self, make_worker: WorkerFactory) -> None:
        self._worker = make_worker()

    def attempt(self, task: Task) -> Outcome:
        return attempt(self._worker, task)


def _import_ray() -> Any:
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
    os.environ.setdefault("RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO", "0")
    try:
        import ray
    except ImportError as error:
        raise MissingExtraError(
            "more than one worker needs Ray: pip install 'toponav[ray]', or leave --workers at 1"
        ) from error
    return ray


def _join(ray: Any, size: int, address: str | None) -> None:
    quiet = {"log_to_driver": False, "logging_level": "ERROR", "configure_logging": True}
    if address is None:
        ray.init(num_cpus=size, include_dashboard=False, **quiet)
        return
    _check_reachable(address)
    try:
        ray.init(address=address, **quiet)
    except (ConnectionError, RuntimeError, ValueError) as error:
        raise InputError(f"--ray-address {address}: no Ray cluster answers there") from error


def _check_room(ray: Any, size: int) -> None:
    """A worker that never gets its CPU would keep its task for ever."""
    cpus = int(ray.cluster_resources().get("CPU", 0))
    if cpus < size:
        raise InputError(
            f"--workers {size}: the Ray cluster has {cpus} CPUs; ask for that many at most"
        )


def _check_reachable(address: str) -> None:
    """Ray itself tries for minutes."""
    host, _, port = address.removeprefix("ray://").rpartition(":")
    if not host or not port.isdecimal():
        raise InputError(
            f"--ray-address takes HOST:PORT of the cluster's head such as 10.0.0.1:{DEFAULT_PORT}, "
            f"not {address!r}"
        )
    with contextlib.ExitStack() as stack:
        try:
            peer = socket.create_connection((host, int(port)), CONNECT_TIMEOUT_S)
            stack.enter_context(peer)
        except (OSError, OverflowError) as error:
            raise InputError(
                f"--ray-address {address}: nothing answers there; start the cluster's head with "
                f"`ray start --head --port {port}`, or leave the option out"
            ) from error
