"""What met the stock and should not have."""

from dataclasses import dataclass, field

import pytest

from simulator.machine.contacts import LEAST_VOLUME, MOST, contacts
from simulator.removal.collision import Collision
from stepnc_model.errors import Severity


def hit(block: int, *, depth: float = 0.5, volume: float = 0.0) -> Collision:
    return Collision(
        segment=0, block=block, depth=depth, position=(1.0, -2.5, 3.0), volume=volume
    )


@dataclass
class Stock:
    collisions: list[Collision] = field(default_factory=list)
    holder_collisions: list[Collision] = field(default_factory=list)
    shank_collisions: list[Collision] = field(default_factory=list)


def test_nothing_met_is_nothing_said() -> None:
    assert contacts(Stock()) == []


def test_each_kind_says_what_where_and_how_much() -> None:
    found = contacts(Stock([hit(4, volume=12.5)], [hit(5, depth=0.25)], [hit(6, depth=1.5)]))
    assert [finding.line for finding in found] == [4, 5, 6]
    assert [finding.severity for finding in found] == [
        Severity.ERROR,
        Severity.WARNING,
        Severity.WARNING,
    ]
    rapid, holder, shank = (finding.message for finding in found)
    assert "rapid" in rapid
    assert "12.5 mm³" in rapid
    assert "holder is 0.25 mm deep" in holder
    assert "1.5 mm of material" in shank
    assert all("(1.00, -2.50, 3.00) mm" in text for text in (rapid, holder, shank))


def test_rounding_of_the_map_is_no_collision() -> None:
    assert contacts(Stock([hit(4, volume=LEAST_VOLUME)])) == []


@pytest.mark.parametrize("row", [0, 1, 2])
def test_many_are_counted(row: int) -> None:
    kinds: list[list[Collision]] = [[], [], []]
    kinds[row] = [hit(line, volume=1.0) for line in range(1, MOST + 8)]
    found = contacts(Stock(*kinds))
    assert len(found) == MOST + 1
    assert found[-1].message.startswith("7 more ")
