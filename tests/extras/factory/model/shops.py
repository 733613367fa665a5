"""Shops for tests, as users write them: TOML text, read and run."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from extras.factory.model.floor import Floor
from extras.factory.model.machining import MachiningPlan
from extras.factory.model.measures import Level, Measure, Quantity, half_width
from extras.factory.model.records import Listeners, PartMade, StateSpent
from extras.factory.model.shop import Shop
from extras.factory.model.shop_figures import measures_of
from extras.factory.model.shop_file import read_shop
from extras.factory.model.streams import Streams
from extras.factory.model.tally import Tally

REPLICATIONS = 30


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Ran:
    """A shop that has run, with all that it told."""

    shop: Shop
    tally: Tally
    floor: Floor
    parts: Sequence[PartMade]
    states: Sequence[StateSpent]
    measures: Sequence[Measure]

    def value(self, level: Level, quantity: Quantity, name: str = "") -> float:
        """One figure."""
        return value_of(self.measures, level, quantity, name)


def value_of(
    measures: Sequence[Measure], level: Level, quantity: Quantity, name: str = ""
) -> float:
    """One figure of a run."""
    return next(
        each.value
        for each in measures
        if (each.level, each.quantity, each.name) == (level, quantity, name)
    )


def shop_of(text: str, folder: Path) -> Shop:
    """Shop of a TOML text."""
    path = folder / "shop.toml"
    path.write_text(text, encoding="utf-8")
    return read_shop(path)


def ran(shop: Shop, *, seed: int = 1, replication: int = 0) -> Ran:
    """Run a shop to its end."""
    parts: list[PartMade] = []
    states: list[StateSpent] = []
    floor = Floor(
        shop,
        MachiningPlan(),
        Streams(seed=seed, replication=replication),
        Listeners(part=(parts.append,), state=(states.append,)),
    )
    floor.run(shop.duration)
    return Ran(
        shop=shop,
        measures=measures_of(floor),
        tally=floor.tally,
        floor=floor,
        parts=parts,
        states=states,
    )


Figure = tuple[Level, Quantity, str]


def intervals(shop: Shop, *figures: Figure) -> list[tuple[float, float]]:
    """Means and half-widths of the 99.9 % intervals of figures over replications."""
    runs = [ran(shop, replication=row) for row in range(REPLICATIONS)]
    found = []
    for figure in figures:
        values = [run.value(*figure) for run in runs]
        found.append((sum(values) / len(values), half_width(values, confidence=0.999)))
    return found
