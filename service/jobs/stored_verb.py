"""Declaration of a verb that jobs run."""

from dataclasses import dataclass

from service.requests.fields import Request


@dataclass(frozen=True, slots=True, kw_only=True)
class StoredVerb:
    """A verb that jobs run."""

    name: str
    """Name of the verb, with a dot between two words."""
    request: type[Request]
    """Its request as jobs have it: with ids of what was uploaded."""
    output: str = ""
    """Name of the file that it writes; empty: its result keeps what there is."""
