"""The first findings of each severity, and how many more."""

from stepnc_model.errors import MOST_FINDINGS, Finding, FindingList, Severity


def finding(severity: Severity, line: int) -> Finding:
    return Finding(severity=severity, message="odd", line=line)


def test_few_findings_are_all_listed_by_line() -> None:
    found = FindingList()
    found.extend(finding(Severity.NOTE, line) for line in (3, 1, 2))
    assert [each.line for each in found.all()] == [1, 2, 3]


def test_an_error_behind_many_notes_is_listed() -> None:
    found = FindingList()
    found.extend(finding(Severity.NOTE, line) for line in range(2 * MOST_FINDINGS))
    assert not found.has_room(Severity.NOTE)
    assert found.has_room(Severity.ERROR)
    found.add(finding(Severity.ERROR, 5))
    listed = found.all()
    assert sum(each.severity is Severity.ERROR for each in listed) == 1
    assert listed[-1].message == f"{MOST_FINDINGS} more notes are not listed here"
    assert len(listed) == MOST_FINDINGS + 2


def test_errors_that_are_only_counted_are_an_error_still() -> None:
    found = FindingList()
    found.count(Severity.ERROR, 7)
    (rest,) = found.all()
    assert (rest.severity, rest.message) == (
        Severity.ERROR,
        "7 more errors are not listed here",
    )
