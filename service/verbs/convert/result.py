"""Result of ``convert``: what was written, and what could not be said in it."""

from dataclasses import dataclass
from pathlib import Path

from service.rendering.view import Fact, Findings, ResultView, TextLine
from service.verbs.convert.request import Standard
from service.verbs.result import Result
from stepnc_model.editing.file_profile import FileProfile
from stepnc_model.errors import Finding


@dataclass(frozen=True, slots=True, kw_only=True)
class ConvertResult(Result):
    """Program that was written in another form."""

    name: str
    written: Path
    form: Standard | FileProfile
    findings: tuple[Finding, ...] = ()
    """What could not be said by the other standard."""

    @property
    def said(self) -> str:
        """Summary in one line."""
        if isinstance(self.form, Standard):
            return f"{self.written}: written by standard '{self.form.value}'"
        return f"{self.written}: records converted to profile '{self.form.value}'"

    def view(self) -> ResultView:
        """Return what was told, and the file for programs."""
        is_standard = isinstance(self.form, Standard)
        return ResultView([
            Fact(key="program", value=self.name),
            Fact(key="written", value=str(self.written)),
            Fact(key="standard", value=self.form.value if is_standard else None),
            Fact(key="profile", value=None if is_standard else self.form.value),
            Findings(findings=self.findings, reported=self.findings),
            TextLine(text=self.said, is_reported=True),
        ])
