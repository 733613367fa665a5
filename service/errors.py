"""Errors of the service: requests that it refuses, and failures of its environment.

::

    ServiceError
    ├── NotFound(thing, id)       the resource does not exist or was deleted
    ├── Conflict                  the state of the resource does not allow the request
    │   └── PreconditionFailed    the resource has changed since the client read it
    ├── TooLarge(bound)           more bytes than are accepted
    ├── Unreadable                the body, a cursor or a header is malformed
    ├── Unauthorised              the API key is missing or unknown
    ├── Forbidden                 the API key lacks the role for this request
    ├── TooMany(wait)             more requests than the rate limit allows
    ├── StorageFull               the disk is full
    ├── Unavailable               something that the service depends on is missing
    └── MissingArgument           a command was called without what it needs
"""

from stepnc_model.errors import StepNcError


class ServiceError(StepNcError):
    """Base class of errors raised by the service itself."""


class NotFound(ServiceError):
    """The requested resource does not exist, or was deleted.

    Parameters
    ----------
    thing : str
        Kind of resource that was looked for, e.g. ``program``.
    """

    def __init__(self, thing: str, id: str) -> None:
        super().__init__(f"there is no {thing} '{id}'")
        self.thing = thing
        self.id = id


class Conflict(ServiceError):
    """The request conflicts with the current state of the resource."""


class PreconditionFailed(Conflict):
    """The resource has changed since the client read it (If-Match)."""


class TooLarge(ServiceError):
    """The content is larger than accepted.

    Parameters
    ----------
    bound : int
        Largest accepted size, in bytes.
    """

    def __init__(self, what: str, *, bound: int) -> None:
        super().__init__(f"{what} is larger than {bound} bytes, the largest size accepted")
        self.bound = bound


class Unreadable(ServiceError):
    """A request body, page cursor or header is malformed."""


class Unauthorised(ServiceError):
    """The API key is missing or unknown."""


class Forbidden(ServiceError):
    """The API key does not allow this request."""


class TooMany(ServiceError):
    """The client has sent more requests than the rate limit allows.

    Parameters
    ----------
    wait : float
        Time until the next request is accepted, in s.
    """

    def __init__(self, wait: float) -> None:
        super().__init__(f"too many requests: try again in {wait:.1f} s")
        self.wait = wait


class StorageFull(ServiceError):
    """The disk has no space left."""


class Unavailable(ServiceError):
    """Something that the service depends on is missing or does not answer."""


class MissingArgument(StepNcError):
    """A command was called without what it needs."""


OK, USAGE, BAD_INPUT, INFEASIBLE, LIMIT_EXCEEDED, NOTHING_ADVISED = 0, 2, 3, 4, 5, 6
"""Exit codes; ``USAGE`` is argparse's; with ``NOTHING_ADVISED`` nothing was written."""
