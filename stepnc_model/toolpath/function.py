"""NC functions between workingsteps: what the control does besides cutting (ISO 14649-10)."""

from dataclasses import dataclass

from stepnc_model.entities.entity import Entity
from stepnc_model.part21.values import Ref

LEFT_OUT = "LEFT_OUT"
"""keyword that no file has: here a workingstep is missing"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Function:
    """One NC function in the order of the program."""

    ref: Ref[Entity]
    keyword: str
    """EXPRESS name in capitals, ``OPTIONAL_STOP``"""
    id: str
    text: str = ""
    """of a message"""
