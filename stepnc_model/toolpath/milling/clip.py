"""Chains cut where they enter and leave an area."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise

from stepnc_model.toolpath.milling.arrays import crossings_with
from stepnc_model.toolpath.milling.contour import Chain, Edge, Loop, chain_length
from stepnc_model.toolpath.milling.cover import Pass
from stepnc_model.toolpath.milling.offset import contains

CHORD = 1e-3
"""mm of tolerance where a point is looked for in an area"""

SHORTEST = 0.1
"""mm; a shorter piece inside is no cut"""


@dataclass(frozen=True, slots=True)
class Piece:
    """Part of a chain on one side of a boundary."""

    chain: Chain
    is_inside: bool


def pieces(chain: Chain, loops: Sequence[Loop]) -> list[Piece]:
    """A chain cut at the boundary of an area on the left of every loop."""
    edges = [edge for loop in loops for edge in loop]
    parts = crossings_with(chain, edges)
    split = [piece for edge, at in zip(chain, parts, strict=True) for piece in _split(edge, at)]
    inside = contains(loops, [piece.at(0.5) for piece in split], tolerance=CHORD)
    pairs = zip(split, inside, strict=True)
    return [
        Piece(tuple(edge for edge, _ in group), is_inside)
        for is_inside, group in groupby(pairs, key=lambda pair: pair[1])
    ]


def inside(cut: Pass, loops: Sequence[Loop]) -> list[Pass]:
    """Parts of a pass inside an area; the pass itself where it stays there."""
    found = pieces(cut.chain, loops)
    if len(found) == 1:
        return [cut] if found[0].is_inside else []
    if cut.is_closed and found[0].is_inside and found[-1].is_inside:
        last = found.pop()
        found[0] = Piece((*last.chain, *found[0].chain), is_inside=True)
    return [
        Pass(piece.chain, is_closed=False)
        for piece in found
        if piece.is_inside and chain_length(piece.chain) > SHORTEST
    ]


def _split(edge: Edge, parts: list[float]) -> Chain:
    """The edge cut at some parts of its length."""
    cuts = [0.0, *(part for part in parts if 1e-9 < part < 1.0 - 1e-9), 1.0]
    return tuple(edge.between(low, high) for low, high in pairwise(cuts) if high > low)
