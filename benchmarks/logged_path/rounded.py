"""Lines and arcs of a path with rounded corners. Units mm, rad."""

import numpy as np

from simulator.motion.segments import Floats, Segments

NEVER = 1e-6  # mm, lengths below this are none


def rounded(vertices: Floats, radius: Floats) -> Segments:
    """Path through vertices, the corners at those with a radius rounded by tangent arcs.

    Arcs that do not both fit on the line between them are made smaller in proportion. Feeds are
    1 mm/s; every line and arc is a block of its own, numbered from 0.

    Parameters
    ----------
    vertices : (K, 3) array, mm
    radius : (K,) array, mm
        0: a sharp corner, as at both ends; two lines with an arc between them are level.
    """
    kept = np.append(np.linalg.norm(np.diff(vertices, axis=0), axis=1) > NEVER, True)
    vertices, radius = vertices[kept], radius[kept]
    ways = np.diff(vertices, axis=0)
    length = np.linalg.norm(ways, axis=1)
    along = ways / length[:, None]
    turn = np.where(radius > 0.0, _turns(along), 0.0)
    arm = radius * np.tan(0.5 * np.abs(turn))
    share = np.minimum(1.0, length / np.maximum(arm[:-1] + arm[1:], NEVER))
    arm *= np.minimum(np.append(share, 1.0), np.append(1.0, share))
    enter = vertices - arm[:, None] * np.vstack([along[:1], along])
    leave = vertices + arm[:, None] * np.vstack([along, along[-1:]])
    points = np.stack([enter, leave], axis=1).reshape(-1, 3)[1:-1]
    return _segments(points, turn[1:-1])


def _turns(along: Floats) -> Floats:
    """Angle of each corner in XY, positive to the left; 0 at both ends."""
    before, after = along[:-1], along[1:]
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    angle = np.arctan2(cross, (before[:, :2] * after[:, :2]).sum(axis=1))
    return np.concatenate([[0.0], angle, [0.0]])


def _segments(points: Floats, turn: Floats) -> Segments:
    """Lines and arcs in turn, the first and the last a line; those without length left out."""
    start, end = points[:-1], points[1:]
    angle = np.zeros(len(start))
    angle[1::2] = turn
    chord = end - start
    middle = 0.5 * (start + end)
    left = np.stack([-chord[:, 1], chord[:, 0], np.zeros(len(chord))], axis=1)
    bent = np.where(angle == 0.0, np.pi, angle)
    centre = middle + 0.5 * left / np.tan(0.5 * bent)[:, None]
    kept = np.linalg.norm(chord, axis=1) > NEVER
    count = int(kept.sum())
    return Segments(
        start=start[kept],
        end=end[kept],
        speed=np.ones(count),
        is_rapid=np.zeros(count, dtype=np.bool_),
        centre=centre[kept],
        turn=angle[kept],
        normal=np.full(count, 2),
        block=np.arange(count),
    )
