"""Error classes of the project: one root, one branch per package.

::

    StepNcError
    ├── Part21Error(line, column)          the text is not valid ISO 10303-21
    ├── SchemaError(entity, attribute)     the instances are not a usable ISO 14649 program
    ├── WriteError(path)                   the result could not be written
    ├── PathError(entity, attribute)       no tool path can be made for a workingstep
    ├── PostError(line)                    NC code that a control or a reader cannot take
    ├── SimulationError                    simulator.errors
    │   ├── UnknownMachine, UnknownMaterial, AgentError
    │   ├── LibraryError(path, key, line)
    │   ├── Deadlock(waits, time)          machines of a shop wait for each other
    │   └── CalibrationError(path, line, column)
    ├── OptimisationError                  optimiser.errors
    │   ├── Infeasible(limits, station)
    │   └── SolverFailed(status)
    ├── ControlError                       controller.errors
    │   └── MachineLost
    ├── KnowledgeError(place)              kbe.errors
    │   ├── StoreDamaged, StoreUnavailable, StoreFull, StoreBusy, StoreReadOnly, StoreTooNew
    │   └── UnknownCorrection(id)
    └── ServiceError                       service.errors
        ├── NotFound(thing, id), Conflict, PreconditionFailed, TooLarge(bound), Unreadable
        └── Unauthorised, Forbidden, TooMany(wait), StorageFull, Unavailable

A programming mistake of the caller is a ``ValueError`` or ``TypeError``; a bad file or an
impossible cut is in this tree. Anything that is not a failure (a deviation from the schema, an
assumption) is a :class:`Finding`; a :class:`FindingList` keeps the first findings of each
severity and counts the rest.
"""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum


class StepNcError(Exception):
    """Root of every error that a user of the project can cause."""


class Part21Error(StepNcError):
    """The bytes are not a valid ISO 10303-21 exchange structure.

    Parameters
    ----------
    message : str
        What was found and what was expected.
    line, column : int
        Place in the file, both counted from 1.
    """

    def __init__(self, message: str, *, line: int = 1, column: int = 1) -> None:
        super().__init__(f"line {line}, column {column}: {message}")
        self.line = line
        self.column = column


class SchemaError(StepNcError):
    """An instance lacks something that a machining program requires.

    Parameters
    ----------
    message : str
        Rule that is violated.
    entity : str
        Instance as the file names it, ``#19 PLANE_FINISH_MILLING``; empty for the whole
        file.
    attribute : str
        EXPRESS name of the attribute, or empty.
    line : int
        Line of the instance, counted from 1; 0 for the whole file.
    """

    def __init__(
        self, message: str, *, entity: str = "", attribute: str = "", line: int = 0
    ) -> None:
        place = f"line {line}: " if line else ""
        name = f"{entity}.{attribute}: " if attribute else (f"{entity}: " if entity else "")
        super().__init__(f"{place}{name}{message}")
        self.rule = message
        self.entity = entity
        self.attribute = attribute
        self.line = line


class PathError(SchemaError):
    """No tool path can be made: the feature, the tool or the strategy does not allow it."""


class PostError(StepNcError):
    """NC code cannot be written for a control, or cannot be read.

    Parameters
    ----------
    message : str
        What was found and what was expected.
    line : int
        Line of the NC code, counted from 1; 0 if unknown.
    """

    def __init__(self, message: str, *, line: int = 0) -> None:
        super().__init__(f"line {line}: {message}" if line else message)
        self.line = line


class WriteError(StepNcError):
    """A result could not be written; no partial file was left behind.

    Parameters
    ----------
    message : str
        Reason given by the operating system or by a rule.
    path : str
        File that was to be written.
    """

    def __init__(self, message: str, *, path: str) -> None:
        super().__init__(f"{path}: {message}")
        self.path = path


class Severity(StrEnum):
    """Severity of a finding: note, warning or error."""

    NOTE = "note"
    """Information about an assumption, a default or an outdated name."""
    WARNING = "warning"
    """Deviation from the standard that a machinist should see."""
    ERROR = "error"
    """The named instance cannot be used."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """Deviation or remark that is reported rather than raised."""

    severity: Severity
    message: str
    entity: str = ""
    """Instance as the file names it, ``#19 PLANE_FINISH_MILLING``."""
    attribute: str = ""
    line: int = 0
    """Line of the instance, counted from 1; 0 for the whole file."""
    rule: str = ""
    """Violated clause or rule, for example ``ISO 14649-11 WR1``."""

    def __str__(self) -> str:
        place = f"line {self.line}: " if self.line else ""
        name = f"{self.entity}.{self.attribute}" if self.attribute else self.entity
        rule = f" ({self.rule})" if self.rule else ""
        return f"{self.severity}: {place}{name + ': ' if name else ''}{self.message}{rule}"


MOST_FINDINGS = 1000
"""Greatest number of findings listed per severity; a file could hold millions."""


class FindingList:
    """Collector of the findings of one file; it lists the first and counts the rest."""

    def __init__(self) -> None:
        self._kept: list[Finding] = []
        self._counts: Counter[Severity] = Counter()

    def add(self, finding: Finding) -> None:
        """Add a finding to the list."""
        if self.has_room(finding.severity):
            self._kept.append(finding)
        self._counts[finding.severity] += 1

    def extend(self, findings: Iterable[Finding]) -> None:
        """Add several findings in order."""
        for finding in findings:
            self.add(finding)

    def has_room(self, severity: Severity) -> bool:
        """True if another finding of a severity would be listed."""
        return self._counts[severity] < MOST_FINDINGS

    def count(self, severity: Severity, number: int = 1) -> None:
        """Count further findings without listing them."""
        self._counts[severity] += number

    def all(self) -> tuple[Finding, ...]:
        """Listed findings by line, and a summary for each severity that was truncated."""
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
