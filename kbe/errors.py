"""Errors of the knowledge base, a branch of the error tree (:mod:`stepnc_model.errors`).

::

    KnowledgeError(place)
    ├── StoreDamaged(reason)            stored data can no longer be read
    ├── StoreUnavailable(reason)        the store cannot be opened or reached
    │   └── DriverMissing               the database driver is not installed
    ├── StoreReadOnly                   the store may be read, but not written
    ├── StoreBusy                       other programs lock the store for too long
    ├── StoreFull                       the disk is full
    ├── StoreTooNew(actual, known)      a newer program made the store
    ├── StoreNotEmpty(rows)             a backup can only be restored into an empty store
    ├── OutcomeDiffers(run, workingstep, column, recorded, value)
    │                                   an outcome was recorded before with other values
    ├── BackupExists                    a backup is never overwritten
    ├── BackupDiffers                   a copy differs from its source
    └── UnknownCorrection(id)           no correction has this id

``place`` is a file, or the address of a server without its password.
"""

from stepnc_model.errors import StepNcError
from stepnc_model.plurals import counted


class KnowledgeError(StepNcError):
    """Base class of the errors of the knowledge base.

    Parameters
    ----------
    message : str
        What is wrong and what to do.
    place : str
        File, or address without password.
    """

    def __init__(self, message: str, *, place: str) -> None:
        super().__init__(f"{place}: {message}")
        self.place = place


class StoreDamaged(KnowledgeError):
    """Stored data can no longer be read."""

    def __init__(self, place: str, *, reason: str) -> None:
        super().__init__(
            f"damaged, or not a knowledge base ({reason}); it was not changed. Keep it, "
            "and restore a backup under another name: stepnc kbe restore FILE",
            place=place,
        )
        self.reason = reason


class StoreUnavailable(KnowledgeError):
    """The store cannot be opened or reached; the reason states what to do."""

    def __init__(self, place: str, *, reason: str) -> None:
        super().__init__(reason, place=place)
        self.reason = reason


class DriverMissing(StoreUnavailable):
    """The package that PostgreSQL needs is not installed."""

    def __init__(self, place: str) -> None:
        reason = (
            "PostgreSQL needs the package psycopg: pip install 'stepnc-optimiser[postgres]'"
        )
        super().__init__(place, reason=reason)


class StoreReadOnly(KnowledgeError):
    """The store may be read, but not written."""

    def __init__(self, place: str) -> None:
        super().__init__(
            "is read-only; allow this user to write the file and its folder, or grant the "
            "rights on the server",
            place=place,
        )


class StoreBusy(KnowledgeError):
    """Other programs lock the store for too long."""

    def __init__(self, place: str) -> None:
        super().__init__(
            "is locked by another program; stop that program, then try again", place=place
        )


class StoreFull(KnowledgeError):
    """The disk is full."""

    def __init__(self, place: str) -> None:
        super().__init__(
            "the disk is full; data stored before is safe. Free some space, then try again",
            place=place,
        )


class StoreTooNew(KnowledgeError):
    """The store was made by a newer program version."""

    def __init__(self, place: str, *, actual: str, known: str) -> None:
        super().__init__(
            f"has schema {actual}, this program knows up to {known}; "
            "install the newer stepnc-optimiser",
            place=place,
        )
        self.actual = actual
        self.known = known


class StoreNotEmpty(KnowledgeError):
    """The store already holds rows, so that a backup cannot be restored into it."""

    def __init__(self, place: str, *, rows: int) -> None:
        super().__init__(
            f"holds {counted(rows, 'row')} that differ from the backup; "
            "restore into a new file or an empty database",
            place=place,
        )
        self.rows = rows


class OutcomeDiffers(KnowledgeError):
    """An outcome was recorded before, with other values.

    Parameters
    ----------
    place : str
        File, or address without password.
    run, workingstep : str
        Outcome that is meant.
    column : str
        First column that differs.
    recorded, value : object
        Value in the store, and the one that was to be added.
    """

    def __init__(
        self,
        place: str,
        *,
        run: str,
        workingstep: str,
        column: str,
        recorded: object,
        value: object,
    ) -> None:
        super().__init__(
            f"run '{run}', workingstep '{workingstep}' is recorded already with {column} "
            f"{recorded}, not {value}; nothing was added. Give another run an id of its own, "
            "and a workingstep that ran again in this run another sequence",
            place=place,
        )
        self.run = run
        self.workingstep = workingstep
        self.column = column
        self.recorded = recorded
        self.value = value


class BackupExists(KnowledgeError):
    """The backup file already exists and is not overwritten."""

    def __init__(self, place: str) -> None:
        super().__init__("already exists; name another file", place=place)


class BackupDiffers(KnowledgeError):
    """A copy differs from its source."""

    def __init__(self, place: str) -> None:
        super().__init__(
            "the copy differs from the original and was discarded; "
            "check memory and disk, then try again",
            place=place,
        )


class UnknownCorrection(KnowledgeError):
    """No correction has the given id."""

    def __init__(self, place: str, *, id: int) -> None:
        super().__init__(
            f"has no correction {id}; list them: stepnc kbe corrections", place=place
        )
        self.id = id
