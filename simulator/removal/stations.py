"""What the tool meets along a path: one row a station, whatever the process.

``section`` is the volume removed per length of path, so that the removal rate is section times
the speed along the path, and ``chip_ratio`` is the mean chip thickness over the feed per tooth:
with the two, force and power need not know whether the cut is milling, drilling or turning.
"""

from dataclasses import dataclass, fields
from enum import IntEnum

import numpy as np

from simulator.motion.segments import Bools, Floats, Ints


class CutKind(IntEnum):
    """Which process."""

    AIR = 0
    MILLING = 1
    DRILLING = 2
    TURNING = 3


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Stations:
    """M stations, ascending along the path; each holds for the stretch before it.

    The first station of a segment holds from the segment's start, each other one from the
    station before it; the last lies on the segment's end. Segments that remove nothing have
    one row of kind AIR at their end.
    """

    segment: Ints
    """(M,) row of the segment"""
    station: Floats
    """(M,) mm along that segment: the end of the stretch"""
    kind: Ints
    """(M,) :class:`CutKind`"""
    section: Floats
    """(M,) mm², volume removed per mm of path"""
    axial_depth: Floats
    """(M,) mm, a_p; in turning the depth of cut; 0 in air"""
    radial_width: Floats
    """(M,) mm, a_e: section over axial depth in milling; of a lip or an insert elsewhere"""
    entry_angle: Floats
    """(M,) rad, φ_st of the arc that holds all contact; milling only"""
    exit_angle: Floats
    """(M,) rad, φ_ex"""
    contact_angle: Floats
    """(M,) rad of contact, all arcs together; φ_ex − φ_st when there is one arc"""
    chip_ratio: Floats
    """(M,) mean chip thickness over feed per tooth"""
    diameter: Floats
    """(M,) mm at which the cutting speed drives the force: of the cutter where it cuts, of
    the middle of a lip, of the workpiece in the middle of the cut"""

    def __post_init__(self) -> None:
        count = len(self.segment)
        for field in fields(self):
            if getattr(self, field.name).shape != (count,):
                raise ValueError(f"{field.name} must have shape {(count,)}")

    def __len__(self) -> int:
        return len(self.segment)

    def engagements(self, rows: Bools, *, digits: int) -> list[list[float]]:
        """Sections, depths, entry and exit angles of some rows, rounded, each once."""
        columns = (self.section, self.axial_depth, self.entry_angle, self.exit_angle)
        met = np.column_stack([column[rows] for column in columns]).round(digits)
        different: list[list[float]] = np.unique(met, axis=0).tolist()
        return different


def air(segments: Ints, length: Floats) -> Stations:
    """Stations of segments that remove nothing.

    Parameters
    ----------
    segments : (M,) array of int
        Their rows.
    length : (M,) array, mm
        Their lengths.
    """
    nothing = np.zeros(len(segments))
    return Stations(
        segment=segments,
        station=length,
        kind=np.full(len(segments), int(CutKind.AIR)),
        section=nothing,
        axial_depth=nothing,
        radial_width=nothing,
        entry_angle=nothing,
        exit_angle=nothing,
        contact_angle=nothing,
        chip_ratio=nothing,
        diameter=nothing,
    )


def merged(parts: list[Stations]) -> Stations:
    """Stations of several runs in the order of their segments."""
    columns = {
        field.name: np.concatenate([getattr(part, field.name) for part in parts])
        for field in fields(Stations)
    }
    order = np.lexsort((columns["station"], columns["segment"]))
    return Stations(**{name: column[order] for name, column in columns.items()})
