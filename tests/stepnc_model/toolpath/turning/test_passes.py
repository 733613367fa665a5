"""Scan lines and passes along a surface."""

from collections.abc import Callable
from itertools import pairwise

import pytest

from stepnc_model.toolpath.path import MoveType, ToolPath
from stepnc_model.toolpath.turning.passes import oriented, shortened
from stepnc_model.toolpath.turning.profile import ProfilePiece

CHAIN = [
    ProfilePiece(start=(5.0, 1.0), end=(0.0, 1.0)),
    ProfilePiece(start=(0.0, 1.0), end=(0.0, 4.0)),
    ProfilePiece(start=(0.0, 4.0), end=(-5.0, 4.0)),
]


def test_a_chain_turned_round_is_still_joined() -> None:
    back = oriented(CHAIN, towards=1)
    assert all(a.end == pytest.approx(b.start) for a, b in pairwise(back))
    assert back[0].start == (-5.0, 4.0)


def test_a_chain_begins_where_it_is_cut_off() -> None:
    assert shortened(CHAIN, 2.0)[0].start == (2.0, 1.0)
    assert shortened(CHAIN, -1.0)[0].start == (-1.0, 4.0)


@pytest.mark.parametrize("name", ["ROUGH CONTOUR", "FINISH CONTOUR", "ROUGH FACE"])
def test_the_first_contact_is_met_at_the_overcut(
    path_of: Callable[..., ToolPath], name: str
) -> None:
    """No cut begins in rapid: a feed through air comes first."""
    moves = path_of(name).moves
    first = next(i for i, move in enumerate(moves) if move.type is MoveType.CONTACT)
    assert moves[first - 1].type is MoveType.NO_CONTACT
