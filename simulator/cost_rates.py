"""Rates of machine and edges, by which time and wear cost money."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class CostRates:
    """Rates by which time and worn edges cost money."""

    currency: str
    machine_rate: float
    """Machine and operator, currency/s."""
    edge_change: float
    """Time to change a worn edge, s."""
    hss_edge: float
    """Cost of a worn edge of high-speed steel, currency."""
    carbide_edge: float
    ceramic_edge: float
    source: str

    def edge_price(self, material: str) -> float:
        """Cost of a worn edge, currency."""
        prices = {
            "hss": self.hss_edge,
            "carbide": self.carbide_edge,
            "ceramic": self.ceramic_edge,
        }
        return prices[material]
