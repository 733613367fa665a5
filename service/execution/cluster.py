"""Dask cluster as an executor.

Dask's workers run what they are sent, so that beyond this machine only encrypted connections
with certificates are taken; their files stand in Dask's own configuration. A worker that is
lost costs only its tasks, which Dask gives to another. A scheduler that is lost forgets
everything: the work is then submitted again by its owner.
"""

from collections.abc import Awaitable, Callable, Iterator
from concurrent.futures import BrokenExecutor, Executor, Future
from contextlib import contextmanager, suppress
from functools import partial
from importlib.metadata import version
from ipaddress import ip_address
from pathlib import Path
from platform import python_version
from typing import TYPE_CHECKING, TypeVar
from urllib.parse import urlsplit

from service.execution.executors import Pools
from service.optional_packages import how_to_install
from stepnc_model.errors import StepNcError

if TYPE_CHECKING:
    from distributed import Client

Result = TypeVar("Result")

SCHEMES = ("tcp", "tls")

PATIENCE = 10.0
"""Longest time, s, to wait for the scheduler, and for a first worker."""


def cluster_pools(address: str) -> Pools:
    """Executors of the cluster whose scheduler has an address.

    Raises
    ------
    StepNcError
        If Dask is not installed, or the cluster is not usable.
    """
    _require_address(address)
    try:
        import distributed  # noqa: F401, PLC0415
    except ImportError as error:
        raise StepNcError(
            f"--cluster {address}: Dask is not installed: {how_to_install('distributed')}"
        ) from error
    _require_certificates(address)
    with cluster(address):
        pass
    return partial(cluster, address)


@contextmanager
def cluster(address: str, *, patience: float = PATIENCE) -> Iterator[Executor]:
    """Executor of a cluster.

    Parameters
    ----------
    address : str
        Address of the scheduler: ``tcp://HOST:PORT`` on this machine, else ``tls://HOST:PORT``.
    patience : float, s
        Longest time to wait for the scheduler, and for a first worker.

    Raises
    ------
    StepNcError
        If the cluster does not answer, has no worker, or workers have other versions.
    BrokenExecutor
        Within it, if tasks were lost with their workers.
    """
    from distributed import Client, KilledWorker  # noqa: PLC0415 (Dask takes a second)
    from distributed.comm.core import CommClosedError  # noqa: PLC0415

    try:
        client = Client(address, timeout=patience, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        raise _unanswered(address, error) from error
    try:
        _require_workers(client, address, patience=patience)
        yield _ClientExecutor(client)
    except (KilledWorker, CommClosedError, TimeoutError) as error:
        raise BrokenExecutor(_first_line(error)) from error
    finally:
        # A scheduler that is away does not answer to a farewell either.
        with suppress(OSError):
            client.close(timeout=patience)


class _ClientExecutor(Executor):
    """Executor over a Dask client.

    Dask's own never ends a future, or ends it with an error of its own, when a worker dies
    while the result is fetched from it.
    """

    def __init__(self, client: "Client") -> None:
        self._client = client

    def submit(
        self, fn: Callable[..., Result], /, *args: object, **kwargs: object
    ) -> Future[Result]:
        """Submit a task that is run again for each call."""
        task = self._client.submit(fn, *args, pure=False, **kwargs)
        future: Future[Result] = Future()
        self._client.loop.add_callback(_finish, task, future)
        return future


async def _finish(task: Awaitable[Result], future: Future[Result]) -> None:
    """End a future as its task ends; a task that is lost ends with a ``CancelledError``."""
    try:
        future.set_result(await task)
    except Exception as error:
        future.set_exception(error)


def _require_workers(client: "Client", address: str, *, patience: float) -> None:
    """Require a worker, and the same versions on all.

    Raises
    ------
    StepNcError
        If there is none, one has other versions, or the scheduler has left.
    """
    try:
        client.wait_for_workers(1, timeout=patience)
    except TimeoutError as error:
        raise StepNcError(
            f"--cluster {address}: has no worker; start one with `dask worker {address}`"
        ) from error
    except OSError as error:
        raise _unanswered(address, error) from error
    try:
        found = client.run(versions, on_error="return")
    except OSError as error:
        raise _unanswered(address, error) from error
    _require_versions(address, found)


def _unanswered(address: str, error: Exception) -> StepNcError:
    """Error of a scheduler that is away."""
    return StepNcError(
        f"--cluster {address}: no scheduler answers ({_first_line(error)}); start one with "
        "`dask scheduler`, and workers with `dask worker ADDRESS`, then repeat the command"
    )


def versions() -> dict[str, str]:
    """Versions that client and workers must share."""
    return {"Python": ".".join(python_version().split(".")[:2])} | {
        name: version(name) for name in ("stepnc-optimiser", "numpy", "distributed")
    }


def _require_versions(address: str, found: dict[str, object]) -> None:
    """Refuse workers of other versions: they may not understand what they are sent.

    Raises
    ------
    StepNcError
        With the worker, both versions and what to do.
    """
    own = versions()
    for worker, theirs in found.items():
        if isinstance(theirs, OSError):
            # It has just ended; others do its work.
            continue
        if not isinstance(theirs, dict):
            raise StepNcError(
                f"--cluster {address}: worker {worker} cannot run it ({_first_line(theirs)}): "
                "install stepnc-optimiser there"
            )
        for name, wanted in own.items():
            if theirs.get(name) != wanted:
                raise StepNcError(
                    f"--cluster {address}: worker {worker} has {name} {theirs.get(name)}, here "
                    f"it is {wanted}: install the same version on both"
                )


def _require_address(address: str) -> None:
    """Refuse what is no address of a scheduler, or is not encrypted off this machine."""
    try:
        parts = urlsplit(address)
        host, port = parts.hostname, parts.port
    except ValueError:
        host = port = None
    if not host or not port or parts.scheme not in SCHEMES:
        raise StepNcError(
            f"--cluster {address}: must be tcp://HOST:PORT or tls://HOST:PORT of a scheduler"
        )
    if parts.scheme == "tcp" and not _is_loopback(host):
        raise StepNcError(
            f"--cluster {address}: beyond this machine only tls:// is taken, since workers run "
            "whatever they are sent; name the certificates in Dask's configuration, "
            "distributed.comm.tls"
        )


def _require_certificates(address: str) -> None:
    """Refuse an encrypted connection without certificates."""
    import dask  # noqa: PLC0415

    if not address.startswith("tls:"):
        return
    for key in ("ca-file", "client.cert", "client.key"):
        place = dask.config.get(f"distributed.comm.tls.{key}", None)
        if not place or not Path(place).is_file():
            found = f"names no file: {place}" if place else "is not set"
            raise StepNcError(
                f"--cluster {address}: distributed.comm.tls.{key} {found} in Dask's "
                "configuration, which an encrypted connection needs"
            )


def _is_loopback(host: str) -> bool:
    """True if a host is this machine."""
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def _first_line(error: object) -> str:
    return (str(error).strip() or type(error).__name__).splitlines()[0]
