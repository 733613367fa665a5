"""Result of ``keys revoke``."""

from dataclasses import dataclass

from service.verbs.result import DoneResult


@dataclass(frozen=True, slots=True, kw_only=True)
class RevokedResult(DoneResult):
    """Key that was revoked."""

    revoked: str

    @property
    def said(self) -> str:
        """Name of the revoked key."""
        return f"revoked: {self.revoked}"
