"""Where a shop comes from: a file, or content that a client of the service sent."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from service.requests.factory import ShopTimes
from simulator.factory.shop import Shop
from simulator.factory.shop_file import read_shop
from stepnc_model.errors import StepNcError
from stepnc_model.units import hours_from_seconds, seconds_from_hours

Changes = Mapping[str, float | str]
"""Values by key of a shop file."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ShopSource:
    """Shop that can be read with changes."""

    name: str
    """Name of the file, for messages."""
    read: Callable[[Changes | None], Shop]
    programs: Mapping[str, str] = field(default_factory=dict)
    """Names of programs for display, by their path; known once the shop was read."""


def source_of_file(file: Path) -> ShopSource:
    """Shop of a file."""
    return ShopSource(name=file.name, read=lambda changes: read_shop(file, changes=changes))


def chosen_shop(source: ShopSource, times: ShopTimes, changes: Changes | None = None) -> Shop:
    """Read a shop with the times and changes of a request.

    Raises
    ------
    StepNcError
        When the shop or a change is invalid.
    """
    shop = source.read(changes)
    if times.hours is not None:
        shop = replace(shop, duration=seconds_from_hours(times.hours))
    if times.warm_up_hours is not None:
        shop = replace(shop, warm_up=seconds_from_hours(times.warm_up_hours))
    if shop.warm_up >= shop.duration:
        raise StepNcError(
            f"{source.name}: warm-up {hours_from_seconds(shop.warm_up):g} h: it must be below "
            f"{hours_from_seconds(shop.duration):g} h, the whole time"
        )
    return shop
