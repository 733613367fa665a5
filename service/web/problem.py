"""RFC 9457 problem details of the project's errors, for jobs and the REST API."""

import re
from typing import Any

from kbe.errors import KnowledgeError, StoreBusy, StoreFull, StoreUnavailable, UnknownCorrection
from optimiser.errors import SolverFailed
from service.errors import (
    Conflict,
    Forbidden,
    NotFound,
    PreconditionFailed,
    StorageFull,
    TooLarge,
    TooMany,
    Unauthorised,
    Unavailable,
    Unreadable,
)
from stepnc_model.errors import Part21Error, StepNcError, WriteError

PREFIX = "urn:stepnc:problem:"

STANDARD = frozenset({"type", "title", "status", "detail", "instance"})
"""Standard members of RFC 9457, §3.1, which fields of an error never replace."""

STATUS: tuple[tuple[type[StepNcError], int], ...] = (
    (NotFound, 404),
    (UnknownCorrection, 404),
    (PreconditionFailed, 412),
    (Conflict, 409),
    (TooLarge, 413),
    (Unreadable, 400),
    (Unauthorised, 401),
    (Forbidden, 403),
    (TooMany, 429),
    (StorageFull, 507),
    (StoreFull, 507),
    (Unavailable, 503),
    (StoreBusy, 503),
    (StoreUnavailable, 503),
    (KnowledgeError, 500),
    (SolverFailed, 500),
    (WriteError, 507),
    (Part21Error, 422),
    (StepNcError, 422),
)
"""HTTP status by error class; the first match counts, and 422 (client error) is the default."""

UNAVAILABLE_WAIT = 2
"""Time after which a client may ask again for what did not answer, in s."""

TITLES = {
    "StepNcError": "Request refused",
    "Part21Error": "Not an ISO 10303-21 file",
    "SchemaError": "Not a usable STEP-NC program",
    "NotFound": "Not found",
    "TooLarge": "Too large",
    "TooMany": "Too many requests",
}


def problem_of(error: StepNcError, *, hidden: str = "") -> dict[str, Any]:
    """Return the problem body: type, title, status, detail, and the fields of the error.

    Parameters
    ----------
    hidden : str
        Path of the data folder, which is removed from all texts.
    """
    name = type(error).__name__
    fields = {
        key: value
        for key, value in vars(error).items()
        if _is_plain(value) and key not in STANDARD
    }
    return {
        "type": type_of(name),
        "title": TITLES.get(name, _words(name).capitalize()),
        "status": status_of(error),
        "detail": _without(str(error), hidden),
        **{key: _hidden(value, hidden) for key, value in fields.items()},
    }


def status_of(error: StepNcError) -> int:
    """Return the HTTP status of an error."""
    return next(status for kind, status in STATUS if isinstance(error, kind))


def retry_after(error: StepNcError) -> int | None:
    """Return the seconds after which the same request may succeed; None: it will not."""
    if isinstance(error, TooMany):
        return int(error.wait) + 1
    return UNAVAILABLE_WAIT if status_of(error) == 503 else None


def type_of(name: str) -> str:
    """Return the problem type URN for the name of an error class."""
    return PREFIX + _words(name).replace(" ", "-")


def plain_problem(status: int, title: str, detail: str, **more: object) -> dict[str, Any]:
    """Return a problem body that belongs to no error class."""
    kind = title.lower().replace(" ", "-")
    return {
        "type": PREFIX + kind,
        "title": title,
        "status": status,
        "detail": detail,
        **more,
    }


def _words(name: str) -> str:
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", " ", name).lower()


def _is_plain(value: object) -> bool:
    """True if the value can be written as JSON unchanged."""
    if isinstance(value, tuple):
        return all(isinstance(each, str) for each in value)
    return isinstance(value, str | int | float) and not isinstance(value, bool)


def _hidden(value: Any, folder: str) -> Any:
    if isinstance(value, tuple):
        return tuple(_without(each, folder) for each in value)
    return _without(value, folder) if isinstance(value, str) else value


def _without(text: str, folder: str) -> str:
    return text.replace(f"{folder}/", "").replace(folder, "") if folder else text
