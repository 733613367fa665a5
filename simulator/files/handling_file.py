"""Handling states and power deviation: tables ``[handling]`` and ``[deviation]`` of a machine.

Powers are the total electrical power of the machine in a state; scatter and deviations are
half-widths of uniform distributions, relative to the mean.
"""

from typing import Annotated

from simulator.files.toml_file import FileTable, quantity
from simulator.spec import Handling, HandlingState, PowerDeviation

StateTime = Annotated[float, quantity(0, 1e5, "s")]
StatePower = Annotated[float, quantity(0, 1e6, "W")]
HalfWidth = Annotated[float, quantity(0, 1)]


class HandlingTable(FileTable, frozen=True, kw_only=True):
    """The ``[handling]`` table."""

    batch_setup_s: StateTime
    batch_setup_w: StatePower
    part_setup_s: StateTime
    part_setup_w: StatePower
    part_ejection_s: StateTime
    part_ejection_w: StatePower
    batch_ejection_s: StateTime
    batch_ejection_w: StatePower
    time_scatter: HalfWidth = 0.0
    source: str

    @property
    def handling(self) -> Handling:
        """Handling states in canonical units."""
        return Handling(
            batch_setup=HandlingState(time=self.batch_setup_s, power=self.batch_setup_w),
            part_setup=HandlingState(time=self.part_setup_s, power=self.part_setup_w),
            part_ejection=HandlingState(time=self.part_ejection_s, power=self.part_ejection_w),
            batch_ejection=HandlingState(
                time=self.batch_ejection_s, power=self.batch_ejection_w
            ),
            time_scatter=self.time_scatter,
            source=self.source,
        )


class DeviationTable(FileTable, frozen=True, kw_only=True):
    """The ``[deviation]`` table."""

    feed: HalfWidth
    traverse: HalfWidth
    source: str

    @property
    def deviation(self) -> PowerDeviation:
        """Power deviation as the machine has it."""
        return PowerDeviation(feed=self.feed, traverse=self.traverse, source=self.source)


def handling_table(handling: Handling) -> HandlingTable:
    """Table of a file in which handling states read back equal."""
    return HandlingTable(
        batch_setup_s=handling.batch_setup.time,
        batch_setup_w=handling.batch_setup.power,
        part_setup_s=handling.part_setup.time,
        part_setup_w=handling.part_setup.power,
        part_ejection_s=handling.part_ejection.time,
        part_ejection_w=handling.part_ejection.power,
        batch_ejection_s=handling.batch_ejection.time,
        batch_ejection_w=handling.batch_ejection.power,
        time_scatter=handling.time_scatter,
        source=handling.source,
    )


def deviation_table(deviation: PowerDeviation) -> DeviationTable:
    """Table of a file in which a power deviation reads back equal."""
    return DeviationTable(
        feed=deviation.feed, traverse=deviation.traverse, source=deviation.source
    )
