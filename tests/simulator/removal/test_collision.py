from simulator.motion.segments import lines
from simulator.removal.collision import MOST
from simulator.removal.cutter import Cutter
from simulator.removal.engage import MillingStock
from stepnc_model.programs.program import Stock


def test_a_stock_remembers_no_more_than_so_many_collisions() -> None:
    stock = MillingStock(Stock(low=(0.0, 0.0, -9.0), high=(40.0, 10.0, 0.0)), cell=1.0)
    count = MOST + 50
    # Each rapid takes a little more off: all of them collide.
    depths = [-8.0 * row / count for row in range(count + 1)]
    path = lines([(20.0 + 10.0 * (row % 2), 5.0, depth) for row, depth in enumerate(depths)])
    stock.cut(path, Cutter(diameter=6.0))
    assert len(stock.collisions) == MOST
