"""Errors of the knowledge base say where, what and what to do."""

from kbe.errors import (
    BackupDiffers,
    BackupExists,
    DriverMissing,
    KnowledgeError,
    OutcomeDiffers,
    StoreBusy,
    StoreDamaged,
    StoreFull,
    StoreNotEmpty,
    StoreReadOnly,
    StoreTooNew,
    StoreUnavailable,
    UnknownCorrection,
)
from stepnc_model.errors import StepNcError
from tests.every_case import every_case

ALL = [
    (StoreDamaged("a.db", reason="malformed"), "restore a backup"),
    (StoreUnavailable("a.db", reason="the folder does not exist; make it"), "make it"),
    (DriverMissing("a.db"), "stepnc-optimiser[postgres]"),
    (StoreReadOnly("a.db"), "allow"),
    (StoreBusy("a.db"), "try again"),
    (StoreFull("a.db"), "Free some space"),
    (StoreTooNew("a.db", actual="0009", known="0001"), "install the newer"),
    (StoreNotEmpty("a.db", rows=3), "restore into a new file"),
    (
        OutcomeDiffers(
            "a.db", run="7", workingstep="WS", column="time_s", recorded=1.0, value=2.0
        ),
        "an id of its own",
    ),
    (BackupExists("a.db"), "name another"),
    (BackupDiffers("a.db"), "try again"),
    (UnknownCorrection("a.db", id=7), "list them"),
]


@every_case(("error", "advice"), ALL)
def test_error_names_its_place_and_what_to_do(error: KnowledgeError, advice: str) -> None:
    assert isinstance(error, StepNcError)
    assert error.place == "a.db"
    assert str(error).startswith("a.db: ")
    assert advice in str(error)


def test_errors_carry_fields() -> None:
    newer = StoreTooNew("a.db", actual="0009", known="0001")
    assert (newer.actual, newer.known) == ("0009", "0001")
    assert StoreNotEmpty("a.db", rows=3).rows == 3
    assert UnknownCorrection("a.db", id=7).id == 7
    assert StoreDamaged("a.db", reason="malformed").reason == "malformed"
