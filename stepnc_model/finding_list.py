"""Findings as they are noticed: the first of each severity, and how many more there are."""

from collections import Counter
from collections.abc import Iterable

from stepnc_model.errors import Finding, Severity

MOST_FINDINGS = 1000
"""of one severity that are listed; nobody reads more, and a file could hold millions"""


class FindingList:
    """Findings of one file. Running state."""

    def __init__(self) -> None:
        self._kept: list[Finding] = []
        self._counts: Counter[Severity] = Counter()

    def add(self, finding: Finding) -> None:
        """Take one."""
        if self.has_room(finding.severity):
            self._kept.append(finding)
        self._counts[finding.severity] += 1

    def extend(self, findings: Iterable[Finding]) -> None:
        """Take several in their order."""
        for finding in findings:
            self.add(finding)

    def has_room(self, severity: Severity) -> bool:
        """Whether one more of a severity would be listed."""
        return self._counts[severity] < MOST_FINDINGS

    def count(self, severity: Severity, number: int = 1) -> None:
        """Count findings that are not described."""
        self._counts[severity] += number

    def all(self) -> tuple[Finding, ...]:
        """Those kept, by line, and a last one for each severity that was cut."""
        listed = Counter(finding.severity for finding in self._kept)
        rest = (
            Finding(
                severity=severity,
                message=f"{count - listed[severity]} more {severity}s are not listed here",
            )
            for severity, count in self._counts.items()
            if count > listed[severity]
        )
        return (*sorted(self._kept, key=lambda finding: finding.line), *rest)
