"""Remarks on an NC program: what was not understood, by line, with its text."""

from stepnc_model.errors import Finding, FindingList, Severity
from stepnc_model.nc.text import NcText
from stepnc_model.post.words import shown

NOT_UNDERSTOOD = "not understood: "
"""Beginning of a remark on a block that is not understood."""

NO_UNIT = "the program states no unit"
"""Beginning of a remark on a program without G20 and G21."""


class Remarks:
    """Collector of the remarks on one program; each block is remarked once for a reason."""

    def __init__(self, text: NcText) -> None:
        self._text = text
        self._list = FindingList()
        self._said: set[tuple[int, str]] = set()
        self.first_unread: Finding | None = None
        """First word that neither moves nor switches show; None if they show all."""

    def lost(self, block: int, why: str) -> None:
        """Remark that a block is not understood and stays as it is."""
        self.warn(block, NOT_UNDERSTOOD + why)

    def warn(self, block: int, why: str) -> None:
        """Remark something about a block that a machinist should see."""
        self._add(block, why, Severity.WARNING)

    def note(self, block: int, why: str) -> None:
        """Remark an assumption about a block."""
        self._add(block, why, Severity.NOTE)

    def unread(self, block: int, why: str) -> None:
        """Note what a block says beyond its moves and switches; the first note is kept."""
        if self.first_unread is None:
            text = f"{why}: {shown(self._text.block(block))}"
            line = self._text.line(block)
            self.first_unread = Finding(severity=Severity.NOTE, message=text, line=line)

    def assume(self, why: str) -> None:
        """Warn of an assumption about the whole program."""
        self._list.add(Finding(severity=Severity.WARNING, message=why))

    def all(self) -> tuple[Finding, ...]:
        """All remarks by line."""
        return self._list.all()

    def _add(self, block: int, why: str, severity: Severity) -> None:
        if (block, why) in self._said:
            return
        if self._list.has_room(severity):
            self._said.add((block, why))
        text = shown(self._text.block(block))
        self._list.add(
            Finding(
                severity=severity,
                message=f"{why}: {text}" if text else why,
                line=self._text.line(block),
            )
        )
