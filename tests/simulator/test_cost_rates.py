"""Prices of edges by their material."""

from simulator.library import load_machine
from simulator.spec import CuttingMaterial


def test_every_cutting_material_has_a_price() -> None:
    rates = load_machine("vmc15").costs
    assert rates is not None
    assert [rates.edge_price(each) for each in CuttingMaterial] == [8.0, 6.0, 9.0]
