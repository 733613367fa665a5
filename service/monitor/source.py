"""Sources of monitors: machines with the addresses of their MTConnect agents."""

from collections.abc import Iterable
from dataclasses import dataclass
from urllib.parse import urlsplit

from simulator.client.connection import AgentClient
from simulator.errors import AgentError
from stepnc_model.errors import StepNcError


@dataclass(frozen=True, slots=True, kw_only=True)
class MonitorSource:
    """Machine with the address of its agent."""

    name: str
    """Name of a machine of the library or of the shop."""
    url: str


def source_of(word: str) -> MonitorSource:
    """Read a source that is written ``NAME=URL``.

    Raises
    ------
    StepNcError
        When the name or a valid address is missing, or the address contains a password.
    """
    name, sign, url = (part.strip() for part in word.partition("="))
    if not name or not sign or not url:
        raise StepNcError(
            f"--agent {word}: expected NAME=URL, such as vmc15=http://127.0.0.1:5000/vmc15"
        )
    if "@" in urlsplit(url if "//" in url else f"//{url}").netloc:
        # The address is shown to everybody who may read.
        raise StepNcError(f"--agent {name}: the address must not contain a user or password")
    try:
        AgentClient(url)
    except AgentError as error:
        raise StepNcError(f"--agent {name}: {error}") from error
    return MonitorSource(name=name, url=url)


def sources_of(words: Iterable[str]) -> tuple[MonitorSource, ...]:
    """Read sources, each written ``NAME=URL``.

    Raises
    ------
    StepNcError
        As :func:`source_of`, and when a machine is named twice.
    """
    found: dict[str, MonitorSource] = {}
    for word in words:
        source = source_of(word)
        if source.name in found:
            raise StepNcError(f"--agent {source.name}: this machine has two agents; name one")
        found[source.name] = source
    return tuple(found.values())
