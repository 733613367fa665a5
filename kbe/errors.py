"""The knowledge base's branch of the error tree (:mod:`stepnc_model.errors`).

::

    KnowledgeError(place)
    ├── StoreDamaged(reason)            what is stored cannot be read any more
    ├── StoreUnavailable(reason)        it cannot be opened or reached
    │   └── DriverMissing               the program for this database is not installed
    ├── StoreReadOnly                   it may be read, not written
    ├── StoreBusy                       others write for too long
    ├── StoreFull                       the disk has no room
    ├── StoreTooNew(found, known)       a newer program made it
    ├── StoreNotEmpty(rows)             a backup goes into an empty store only
    ├── BackupExists                    a backup is never overwritten
    ├── BackupDiffers                   a copy is not what it was made from
    └── UnknownCorrection(id)

``place`` is a file, or the address of a server without its password.
"""

from stepnc_model.errors import StepNcError


class KnowledgeError(StepNcError):
    """The knowledge base cannot do what it was asked.

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
    """Stored data that can no longer be read."""

    def __init__(self, place: str, *, reason: str) -> None:
        super().__init__(
            f"damaged, or no knowledge base ({reason}); nothing in it was changed. Keep it, "
            "and restore a backup under another name: stepnc kbe restore FILE",
            place=place,
        )
        self.reason = reason


class StoreUnavailable(KnowledgeError):
    """The store cannot be opened or reached; the reason says what to do."""

    def __init__(self, place: str, *, reason: str) -> None:
        super().__init__(reason, place=place)
        self.reason = reason


class DriverMissing(StoreUnavailable):
    """PostgreSQL needs a package that is not installed."""

    def __init__(self, place: str) -> None:
        reason = (
            "PostgreSQL needs the package psycopg: pip install 'stepnc-optimiser[postgres]'"
        )
        super().__init__(place, reason=reason)


class StoreReadOnly(KnowledgeError):
    """The store may be read, not written."""

    def __init__(self, place: str) -> None:
        super().__init__(
            "is read-only; allow this user to write the file and its folder, or grant the "
            "rights on the server",
            place=place,
        )


class StoreBusy(KnowledgeError):
    """Others write for too long."""

    def __init__(self, place: str) -> None:
        super().__init__(
            "is locked by another program; end what writes there, then try again", place=place
        )


class StoreFull(KnowledgeError):
    """The disk has no room."""

    def __init__(self, place: str) -> None:
        super().__init__(
            "the disk is full; what was accepted before is safe. Make room, then try again",
            place=place,
        )


class StoreTooNew(KnowledgeError):
    """A newer program made the store."""

    def __init__(self, place: str, *, found: str, known: str) -> None:
        super().__init__(
            f"has schema {found}, this program knows up to {known}; "
            "install the newer stepnc-optimiser",
            place=place,
        )
        self.found = found
        self.known = known


class StoreNotEmpty(KnowledgeError):
    """A backup goes into an empty store only."""

    def __init__(self, place: str, *, rows: int) -> None:
        super().__init__(
            f"holds {rows} rows that are not those of the backup; "
            "restore into a new file or an empty database",
            place=place,
        )
        self.rows = rows


class BackupExists(KnowledgeError):
    """A backup is never overwritten."""

    def __init__(self, place: str) -> None:
        super().__init__("exists already; name another file", place=place)


class BackupDiffers(KnowledgeError):
    """A copy is not what it was made from."""

    def __init__(self, place: str) -> None:
        super().__init__(
            "the copy differs from what was copied and was thrown away; "
            "check memory and disk, then try again",
            place=place,
        )


class UnknownCorrection(KnowledgeError):
    """No correction has this id."""

    def __init__(self, place: str, *, id: int) -> None:
        super().__init__(
            f"has no correction {id}; list them: stepnc kbe corrections", place=place
        )
        self.id = id
