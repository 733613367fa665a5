"""Shapes of tools."""

from math import inf, pi

from simulator.removal.cutter import Cutter, Holder, Insert


def test_plain_cutter_is_an_end_mill_without_a_holder() -> None:
    cutter = Cutter(diameter=10.0)
    assert (cutter.corner_radius, cutter.point_angle, cutter.edge_length) == (0.0, pi, inf)
    assert cutter.holder is None
    assert Holder(diameter=40.0, overhang=50.0).overhang == 50.0
    assert Insert().width is None
