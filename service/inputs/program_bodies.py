"""B-rep bodies of a program: its raw part, and its finished part.

A file of ISO 14649 or AP238 may give a workpiece by an ``ADVANCED_BREP_SHAPE_REPRESENTATION``,
in coordinates of the workpiece. Units mm.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pkgutil import resolve_name
from typing import TYPE_CHECKING

from stepnc_model.ap238.view import AimView
from stepnc_model.errors import StepNcError
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Stock

if TYPE_CHECKING:
    from simulator.motion.segments import Floats

ROUND = 0.05
"""Greatest difference of sizes along x, y and around z at which a body counts as a bar, mm."""

TRIANGLES = "extras.brep.solid:solid_triangles"
"""Function of an extra that reads the triangles of a solid."""

USUAL_TOLERANCE = 0.0254
"""Size of the deviations that a raw part shows, 0.001 inch in mm."""


PARTS = 5.0
"""Share of the tolerance by which triangles may lie beside the surface is one in this many."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SolidPlace:
    """Place of a solid in a file."""

    file: Part21File
    name: str
    """Name of the file in messages."""
    root: int | None = None
    """Instance of its geometry; None: anywhere in the file."""
    solid: str = ""
    """Name of the solid, or its place in the list of a message; empty: the only one."""


class ProgramBodies:
    """Bodies of one program, each read once. Running state.

    Parameters
    ----------
    tell : callable
        Takes the reason why a raw part is not known.
    user_triangles : (T, 3, 3) array, mm
        Triangles of a raw part that the user gives, in coordinates of every setup; None: the
        program's own counts.
    """

    def __init__(
        self, tell: Callable[[str], None], user_triangles: "Floats | None" = None
    ) -> None:
        self.user_triangles = user_triangles
        self._tell = tell
        self._raw: dict[int, Floats | None] = {}

    def box(self, file: Part21File, representation: int) -> Stock | None:
        """Box or bar around the raw part; None if it cannot be read, which is told once."""
        triangles = self.raw(file, representation)
        return None if triangles is None else stock_around(triangles)

    def raw(self, file: Part21File, representation: int) -> "Floats | None":
        """Triangles of the raw part, (T, 3, 3); None if it cannot be read, which is told."""
        if representation not in self._raw:
            self._raw[representation] = None
            try:
                self._raw[representation] = body_triangles(
                    file, representation, tolerance=USUAL_TOLERANCE
                )
            except StepNcError as error:
                self._tell(f"the raw part is not known: {error}")
        return self._raw[representation]


def stock_around(triangles: "Floats") -> Stock:
    """Bar around the triangles, (T, 3, 3) in mm, of a round body; box around another."""
    x, y, z = triangles.reshape(-1, 3).T
    low, high = (float(x.min()), float(y.min())), (float(x.max()), float(y.max()))
    middle = (0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]))
    around = float((((x - middle[0]) ** 2 + (y - middle[1]) ** 2) ** 0.5).max())
    widths = (0.5 * (high[0] - low[0]), 0.5 * (high[1] - low[1]))
    is_round = all(abs(each - around) <= ROUND for each in widths)
    return Stock(
        low=(*low, float(z.min())),
        high=(*high, float(z.max())),
        radius=around if is_round else None,
        is_around=True,
    )


def body_triangles(file: Part21File, representation: int, *, tolerance: float) -> "Floats":
    """Triangles of a body of a program, (T, 3, 3), in coordinates of its workpiece.

    Parameters
    ----------
    file : Part21File
        Instances of ISO 14649 of a program.
    representation : int
        Instance of the shape representation.
    tolerance : float, mm
        Size of the deviations that are to be seen.

    Raises
    ------
    StepNcError
        When Open CASCADE is not installed, or the body cannot be read.
    """
    name = f"{file.name}: {file.label(int(representation))}"
    root = representation
    if isinstance(file, AimView):
        root, file = file.origins[representation].origin, file.source
    return triangles_of(SolidPlace(file=file, name=name, root=root), tolerance=tolerance)


def triangles_of(place: SolidPlace, *, tolerance: float) -> "Floats":
    """Triangles of a solid, (T, 3, 3), mm, by the extra that reads them.

    Parameters
    ----------
    place : SolidPlace
    tolerance : float, mm
        Size of the deviations that are to be seen.
    """
    found: Floats = resolve_name(TRIANGLES)(place, tolerance=tolerance)
    return found


def sag_within(tolerance: float) -> float:
    """Greatest distance of triangles from the surface by which a tolerance is seen, mm."""
    return tolerance / PARTS
