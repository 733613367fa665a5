"""Errors of the service's clients, and of its environment.

::

    ServiceError
    ├── NotFound(thing, id)       there is none, or no more
    ├── Conflict                  it is not in the state for that
    │   └── PreconditionFailed    it is not any more what the client has seen
    ├── TooLarge(bound)           more bytes than are taken
    ├── Unreadable                the body, or a part of it, is no such thing
    ├── Unauthorised              no key, or none that is known
    ├── Forbidden                 the key does not open this
    ├── TooMany(wait)             more requests than are taken in a while
    ├── StorageFull               the disk has no room
    └── Unavailable               something the service stands on is missing
"""

from stepnc_model.errors import StepNcError


class ServiceError(StepNcError):
    """Root of what the service itself refuses."""


class NotFound(ServiceError):
    """There is no such thing, or it was deleted.

    Parameters
    ----------
    thing : str
        What was looked for: ``program``.
    id : str
    """

    def __init__(self, thing: str, id: str) -> None:
        super().__init__(f"there is no {thing} '{id}'")
        self.thing = thing
        self.id = id


class Conflict(ServiceError):
    """Request that conflicts with the state of a resource."""


class PreconditionFailed(Conflict):
    """The resource has changed since the client read it (If-Match)."""


class TooLarge(ServiceError):
    """More bytes than are taken.

    Parameters
    ----------
    what : str
    bound : int
        Bytes at most.
    """

    def __init__(self, what: str, *, bound: int) -> None:
        super().__init__(f"{what} is larger than {bound} bytes, which is the most")
        self.bound = bound


class Unreadable(ServiceError):
    """A body, a cursor or a header is not what it should be."""


class Unauthorised(ServiceError):
    """There is no key, or it is not known."""


class Forbidden(ServiceError):
    """The key does not open this."""


class TooMany(ServiceError):
    """More requests than are taken in a while.

    Parameters
    ----------
    wait : float
        S after which the next is taken.
    """

    def __init__(self, wait: float) -> None:
        super().__init__(f"too many requests: the next is taken in {wait:.1f} s")
        self.wait = wait


class StorageFull(ServiceError):
    """The disk has no room."""


class Unavailable(ServiceError):
    """Something that the service stands on does not answer."""
