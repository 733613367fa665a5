"""Instance of ISO 14649 with the AIM instance that stands for it."""

from collections.abc import Mapping
from dataclasses import dataclass

from stepnc_model.ap238.table import Rule
from stepnc_model.entities.conversion import slots_of
from stepnc_model.part21.tidy import tidy_values
from stepnc_model.part21.values import Value
from stepnc_model.part21.writer import format_value


@dataclass(frozen=True, slots=True, kw_only=True)
class Converted:
    """Instance of ISO 14649 with the AIM instance that stands for it."""

    number: int
    keyword: str
    origin: int
    rule: Rule | None
    context: int | None = None
    """Representation context that gives the units of its geometry."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ConvertedText:
    """Converted instance as it is written: its text takes a fraction of its values' memory."""

    instance: Converted
    text: bytes
    """Parameters, ``(...)``."""

    @classmethod
    def of(cls, instance: Converted, parameters: tuple[Value, ...]) -> "ConvertedText":
        """Instance with its parameters."""
        return cls(instance=instance, text=format_value(parameters))

    @property
    def line(self) -> bytes:
        """Line of a file."""
        keyword = self.instance.keyword.encode("ascii")
        return b"#%d=%s%s;" % (self.instance.number, keyword, self.text)

    @property
    def values(self) -> Mapping[str, Value]:
        """Values of the parameters by the names of their attributes."""
        rule = self.instance.rule
        if rule is None:
            return {}
        names = slots_of(rule.entity)
        return dict(zip(names, tidy_values(self.text.decode("latin-1")), strict=False))
