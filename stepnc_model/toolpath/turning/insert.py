"""The insert of a grooving tool: two corners and a flat edge between them.

The programmed point is its left corner, the one at the chuck, as a sharp corner; paths are
made for the centre of that corner's radius. The insert may be where both of its corners and
all between them may be.
"""

from dataclasses import dataclass

from stepnc_model.entities.turning_tools import GroovingTool
from stepnc_model.toolpath.job import Job
from stepnc_model.toolpath.turning.offset import grown
from stepnc_model.toolpath.turning.piece import Piece
from stepnc_model.toolpath.turning.profile import Profile, highest, level_line


@dataclass(frozen=True, slots=True, kw_only=True)
class Insert:
    """A grooving insert, mm."""

    width: float
    corner: float
    """radius of its corners"""
    reach: float
    """how deep it may go"""

    @property
    def flat(self) -> float:
        """Between the centres of its corners."""
        return self.width - 2.0 * self.corner

    def rolled(self, profile: Profile, allowance: float = 0.0) -> Profile:
        """Where the centre of the left corner is when the insert touches a profile."""
        return highest(self._spread(grown(profile, self.corner + allowance)))

    def _spread(self, centres: Profile) -> list[Piece]:
        """The way of both corners, and level lines between equal heights."""
        pieces = [*centres.pieces, *(_shifted(p, -self.flat) for p in centres.pieces)]
        for piece in centres.pieces:
            spots = [piece.start, piece.end]
            if piece.centre and piece.side > 0 and piece.low < piece.centre[0] < piece.high:
                spots.append((piece.centre[0], piece.centre[1] + piece.radius))
            pieces += [level_line(v, u - self.flat, u) for u, v in spots]
        return pieces


def insert_of(job: Job) -> Insert:
    """Insert of the tool of a grooving operation.

    Raises
    ------
    PathError
        When it is no grooving tool, or has no width.
    """
    tool = job.program.get(job.step.tool_ref)
    if not isinstance(tool, GroovingTool):
        raise job.fault("is no grooving tool", job.step.tool_ref)
    width = tool.cutting_width
    if width is None or not 0.0 < width < 1e3:
        raise job.fault(f"a width of {width} mm", job.step.tool_ref, "cutting_width")
    corner = tool.corner_radius
    corner = job.tool.corner_radius or 0.0 if corner is None else corner
    if not 0.0 <= 2.0 * corner <= width:
        message = f"corners of {corner:g} mm on an insert of {width:g} mm"
        raise job.fault(message, job.step.tool_ref, "corner_radius")
    reach = tool.maximum_grooving_depth
    return Insert(width=float(width), corner=float(corner), reach=float(reach or 1e6))


def _shifted(piece: Piece, by: float) -> Piece:
    return Piece(
        start=(piece.start[0] + by, piece.start[1]),
        end=(piece.end[0] + by, piece.end[1]),
        centre=(piece.centre[0] + by, piece.centre[1]) if piece.centre else None,
        side=piece.side,
        radius=piece.radius,
    )
