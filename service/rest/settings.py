"""Settings of the service; passed to its processes in the environment."""

import json
import os
from dataclasses import asdict, dataclass, fields
from pathlib import Path

from service.errors import Unavailable

VARIABLE = "STEPNC_SERVE"
"""environment variable in which the settings go from process to process"""

LOOPBACK = frozenset({"127.0.0.1", "::1", "localhost"})

MIB = 1 << 20


@dataclass(frozen=True, slots=True, kw_only=True)
class Settings:
    """All of them."""

    data: str
    """folder"""
    knowledge: str = ""
    """place of the knowledge base; empty: that of the environment, else in the folder"""
    host: str = "127.0.0.1"
    port: int = 8000
    names: tuple[str, ...] = ()
    """names under which clients know this host, beside the one it listens on"""
    needs_keys: bool = False
    upload_bytes: int = 32 * MIB
    """Upload bytes of a program, unpacked"""
    rate: float = 0.0
    """requests a second of one client, in the long run; 0: as many as there come"""
    burst: int = 100
    """requests at once"""
    body_s: float = 60.0
    """in which a body arrives"""
    level: str = "info"
    """Level of the log"""

    @property
    def has_request_log(self) -> bool:
        """Whether each request is logged."""
        return self.level in {"debug", "info"}

    @property
    def is_loopback(self) -> bool:
        """Whether only this computer can connect."""
        return self.host in LOOPBACK

    @property
    def root(self) -> Path:
        """The data folder."""
        return Path(self.data)

    def hand_on(self) -> None:
        """Put them where processes started from this one find them."""
        os.environ[VARIABLE] = json.dumps(asdict(self))


def handed_on() -> Settings:
    """The settings that the starting process has left.

    Raises
    ------
    Unavailable
        When it has left none.
    """
    text = os.environ.get(VARIABLE)
    if text is None:
        raise Unavailable(f"{VARIABLE} is not set: start the service with `stepnc serve`")
    found = json.loads(text)
    known = {field.name for field in fields(Settings)}
    values = {name: value for name, value in found.items() if name in known}
    return Settings(**{**values, "names": tuple(values.get("names", ()))})
