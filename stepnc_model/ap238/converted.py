"""Instance of ISO 14649 with the AIM instance that stands for it."""

from dataclasses import dataclass

from stepnc_model.ap238.table import Rule
from stepnc_model.part21.values import Value


@dataclass(frozen=True, slots=True, kw_only=True)
class Converted:
    """Instance of ISO 14649 with the AIM instance that stands for it."""

    number: int
    keyword: str
    parameters: tuple[Value, ...]
    origin: int
    rule: Rule | None
    context: int | None = None
    """Representation context that gives the units of its geometry."""
