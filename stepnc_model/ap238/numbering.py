"""Numbers of the instances of ISO 14649 that AIM instances stand for."""

from functools import cache

Kind = tuple[str, float]


@cache
def what(keyword: str, scale: float) -> Kind:
    """Kind of an AIM instance: an entity, and the factor of its lengths.

    One object serves all instances, which saves memory.
    """
    return keyword, scale


class AimNumbering:
    """Numbers of what AIM instances stand for. Running state.

    Parameters
    ----------
    next : int
        First number that no instance of the file has.
    """

    def __init__(self, next: int) -> None:
        self.next = next
        """First number that is not used."""
        self._first: dict[int, Kind] = {}
        """What each AIM instance stands for under its own number."""
        self._further: dict[tuple[int, Kind], int] = {}
        """Numbers of what else it stands for."""

    def __contains__(self, id: int) -> bool:
        """True if an AIM instance stands for anything."""
        return id in self._first

    def known(self, id: int, kind: Kind) -> int | None:
        """Number of what an AIM instance stands for; None before it has one."""
        return id if self._first.get(id) == kind else self._further.get((id, kind))

    def new(self, id: int, kind: Kind) -> int:
        """Number for what an AIM instance stands for: its own, or else a new one."""
        if id not in self._first:
            self._first[id] = kind
            return id
        self._further[id, kind] = self.next
        self.next += 1
        return self.next - 1
