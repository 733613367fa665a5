"""What a mill meets where it goes straight down into the solid at the feed of the cut.

ISO 14649-11 gives an operation one feed, and a plunge along the tool's axis runs at it, so what
the plunge takes holds for the whole cut; a ramp or a helix mills and sets no limit of its own.
There the mill cuts as a drill does, with lips square to its axis. Whether its edges reach the
axis at all the file does not say. Where the material lies under one side of the tool only, all
its lips are taken to cut all the time, which is as hard as it gets. Units mm.
"""

from dataclasses import replace
from math import pi

from optimiser.cut import Cut, CutKind, Texture
from optimiser.hardest import Met
from simulator.motion.segments import Bools
from simulator.removal.stations import CutKind as StationKind

CORE = 0.25
"""of the radius; what does not reach so far in is planed off at the side, not drilled"""

LEAST_SHARE = 0.02
"""of the tool's section, over a stretch that begins above the material; less is a sliver"""


def plunge_of(cut: Cut, met: Met, is_bound: Bools) -> Cut | None:
    """The hardest plunge of a milling cut, as a drill would make it; None where there is none.

    Parameters
    ----------
    cut : Cut
    met : Met
        What its path met.
    is_bound : (N,) array
        Which segments of the path run at the feed of the cut.
    """
    if cut.kind is not CutKind.MILLING:
        return None
    stations = met.stations
    rows = (stations.kind == StationKind.DRILLING) & is_bound[stations.segment]
    rows &= stations.section >= LEAST_SHARE * 0.25 * pi * cut.diameter**2
    # A lip's width is its axial depth here, and twice the radius of its middle the diameter.
    inner = (stations.diameter - stations.axial_depth)[rows]
    if not (inner <= CORE * cut.diameter).any():
        return None
    return replace(
        cut,
        kind=CutKind.DRILLING,
        tool=replace(cut.tool, point_angle=pi),
        previous_diameter=max(0.0, float(inner.min())),
        engagement=None,
        shank=None,
        wall=None,
        depth_share=1.0,
        texture=Texture.NONE,
        floor=None,
        plunge=None,
    )
