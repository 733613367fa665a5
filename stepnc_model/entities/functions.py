"""Functions of the control that need no technology (ISO 14649-10)."""

from __future__ import annotations

from stepnc_model.entities.entity import abstract, entity
from stepnc_model.entities.executables import Channel, Executable
from stepnc_model.entities.tools import MachiningTool
from stepnc_model.part21.values import Ref


@abstract
class NcFunction(Executable):
    """Switching action or message."""


@entity
class DisplayMessage(NcFunction):
    """Message on the screen."""

    its_text: str


@entity
class OptionalStop(NcFunction):
    """Stop if the switch is on."""


@entity
class ProgramStop(NcFunction):
    """Stop until started again."""


@entity
class LoadTool(NcFunction):
    """Tool into the spindle."""

    its_tool: Ref[MachiningTool]


@entity
class UnloadTool(NcFunction):
    """Tool out of the spindle."""

    its_tool: Ref[MachiningTool] | None = None


@entity
class SetMark(NcFunction):
    """Mark that other channels may wait for."""


@entity
class WaitForMark(NcFunction):
    """Wait for the mark of another channel."""

    its_channel: Ref[Channel]


@entity
class ExchangePallet(NcFunction):
    """Next pallet."""


@entity
class IndexPallet(NcFunction):
    """Pallet to a position."""

    its_index: int


@entity
class IndexTable(NcFunction):
    """Table to a position."""

    its_index: int
