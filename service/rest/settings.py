"""Settings of the service, passed to its worker processes in the environment."""

import json
import os
from dataclasses import asdict, dataclass, fields
from pathlib import Path

from service.errors import Unavailable
from service.monitor.source import MonitorSource
from service.storage.folder import FolderAddress
from service.web.known_hosts import LOOPBACK

VARIABLE = "STEPNC_SERVE"
"""Environment variable that passes the settings from process to process."""

MIB = 1 << 20


@dataclass(frozen=True, slots=True, kw_only=True)
class Settings:
    """Settings of the service."""

    data: str
    """Path of the data folder."""
    knowledge: str = ""
    """Knowledge base; empty: from the environment, or else inside the data folder."""
    database: str = ""
    """Address of a PostgreSQL server that several hosts share; empty: a file."""
    files: str = ""
    """Folder, or URL of a store, of the files that these hosts share; empty: in ``data``."""
    host: str = "127.0.0.1"
    port: int = 8000
    names: tuple[str, ...] = ()
    """Additional host names by which clients reach the service."""
    agents: tuple[MonitorSource, ...] = ()
    """MTConnect agents of real machines that are monitored."""
    needs_keys: bool = False
    upload_bytes: int = 32 * MIB
    """Largest program that may be uploaded, unpacked, in bytes."""
    rate: float = 0.0
    """Requests per second that a client may send on average; 0: no limit."""
    burst: int = 100
    """Requests that a client may send at once."""
    body_s: float = 60.0
    """Time within which a request body must arrive, in s."""
    level: str = "info"
    """Level of the log."""
    has_agent: bool = True
    """Whether the MTConnect agent is mounted, which needs a single web process."""

    @property
    def has_request_log(self) -> bool:
        """True if each request is logged."""
        return self.level in {"debug", "info"}

    @property
    def is_loopback(self) -> bool:
        """True if only this computer can connect."""
        return self.host in LOOPBACK

    @property
    def root(self) -> Path:
        """The data folder."""
        return Path(self.data)

    @property
    def address(self) -> FolderAddress:
        """Names by which a process opens the data folder."""
        return FolderAddress(
            root=self.data, files=self.files, database=self.database, knowledge=self.knowledge
        )

    def hand_on(self) -> None:
        """Store the settings in the environment for processes started from this one."""
        os.environ[VARIABLE] = json.dumps(asdict(self))


def handed_on() -> Settings:
    """Load the settings that the parent process has stored in the environment.

    Raises
    ------
    Unavailable
        When the environment holds no settings.
    """
    text = os.environ.get(VARIABLE)
    if text is None:
        raise Unavailable(f"{VARIABLE} is not set: start the service with `stepnc serve`")
    found = json.loads(text)
    known = {field.name for field in fields(Settings)}
    values = {name: value for name, value in found.items() if name in known}
    agents = tuple(MonitorSource(**each) for each in values.get("agents", ()))
    return Settings(**{**values, "names": tuple(values.get("names", ())), "agents": agents})
