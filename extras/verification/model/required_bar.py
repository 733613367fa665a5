"""Required part of a lathe, compared with what a log has left of the bar. Units mm."""

import numpy as np

from extras.verification.model.deviation import SurfacePlaces
from extras.verification.model.logged_bar import LoggedBar, profile_distance
from extras.verification.model.turned_part import compared_profiles, has_bore
from simulator.motion.segments import Bools, Floats
from simulator.removal.mesh_stock import RequiredBar


def required_turned_places(part: RequiredBar, logged: LoggedBar) -> SurfacePlaces:
    """Compare the logged profiles of outside and bore with the required ones."""
    sides = [_side(part, logged, is_bore=False)]
    if has_bore(part.bar, logged):
        sides.append(_side(part, logged, is_bore=True))
    places = SurfacePlaces.joined(sides)
    return places[places.position[:, 2] > part.low + part.bar.cell]


def _side(part: RequiredBar, logged: LoggedBar, *, is_bore: bool) -> SurfacePlaces:
    found = compared_profiles(part.bar, logged, is_bore=is_bore)
    points, nearest = found.points, found.nearest
    by = nearest.workingstep
    return SurfacePlaces(
        is_wall=points.is_face,
        position=found.position,
        deviation=found.deviation,
        uncertainty=np.minimum(nearest.bend, found.reached) + found.uncertainty,
        certain=found.gouge,
        area=points.area,
        workingstep=by,
        block=np.zeros(len(by), dtype=np.int64),
        time=nearest.time,
        cut_by=by,
    )


def profile_deviation(places: SurfacePlaces, is_bore: Bools, part: RequiredBar) -> Floats:
    """Deviation of programmed places from a required profile, (N,), mm.

    Parameters
    ----------
    places : SurfacePlaces
    is_bore : (N,) array of bool
        Whether a place lies in the bore.
    part : RequiredBar

    Returns
    -------
    (N,) array, mm
        Excess positive; NaN behind the required part.
    """
    found = np.full(len(places), np.nan)
    bar = part.bar
    for profile, rows, sign in (
        (bar.outer, ~is_bore, 1.0),
        (bar.inner, is_bore, -1.0),
    ):
        at = places.position[rows][:, [0, 2]]
        if not len(at):
            continue
        away = profile_distance(at, np.column_stack([profile, bar.z]), bar.cell)
        beyond = np.sign(at[:, 0] - np.interp(at[:, 1], bar.z, profile))
        found[rows] = sign * beyond * away
    found[places.position[:, 2] <= part.low + bar.cell] = np.nan
    return found
