"""A hold of the feed after an overload, and how long it is remembered. Running state."""

from dataclasses import dataclass

FORGIVING = 1.0 / 100.0
"""of a hold forgotten in a revolution: holds in quick succession are a fault"""

EASING = 1.0 / 200.0
"""share by which the override that a hold has taught is eased in a revolution: cuts that come
again within a second or two hold the feed now and then, and those that are over cost little"""


BELOW = 500
"""revolutions in a row in which the guard goes below the band, until it stops the program"""


@dataclass(kw_only=True)
class Hold:
    """A hold, and those before it. Running state."""

    count: float = 0.0
    """in this workingstep, old ones less and less"""
    is_on: bool = False
    override: float = 1.0
    """that the axes ran when it began"""
    force: float = 0.0
    """N, greatest since"""
    calm: int = 0
    """tooth periods in a row with a force below the set point: with runout, one says little"""

    below: int = 0
    """revolutions in a row below the floor of the band"""

    def stays_below(self, *, is_below: bool) -> bool:
        """Whether the override has been below the band for too long, this revolution too."""
        self.below = self.below + 1 if is_below else 0
        return self.below > BELOW

    def forgive(self) -> None:
        """One revolution went by."""
        self.count = max(0.0, self.count - FORGIVING)
