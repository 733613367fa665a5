"""Surroundings of a machine in its shop: buffers, crews, machining, counts, listeners."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from extras.factory.model.crews import CrewOnDuty
from extras.factory.model.machining import PartSource
from extras.factory.model.records import Listeners
from extras.factory.model.shop import Product
from extras.factory.model.states import MachineState
from extras.factory.model.store import Batch, BatchBuffer, RawStock
from extras.factory.model.tally import Tally

Steps: TypeAlias = frozenset[tuple[int, int]]
"""Indices of product and step."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Surroundings:
    """Surroundings of a machine in its shop."""

    products: Sequence[Product]
    supplies: Sequence[tuple[BatchBuffer, Steps]]
    """Buffers from which it takes batches, with the steps that it can do."""
    raw: Sequence[RawStock]
    """Raw stocks among them that never run out."""
    behind: Mapping[tuple[int, int], BatchBuffer]
    """Buffer behind each step; none behind the last."""
    machining: Mapping[tuple[int, int], PartSource]
    """Machining of one part after another, by step."""
    crews: Mapping[MachineState, CrewOnDuty]
    """Crews by the states that need a member."""
    tally: Tally
    finished: Callable[[Batch], None]
    """Called with each batch that leaves the shop."""
    started: Callable[[Batch], None]
    """Called with each batch that leaves the raw stock."""
    stuck: Callable[[int], None]
    """Called with the index of the machine when it waits for room."""
    listeners: Listeners
