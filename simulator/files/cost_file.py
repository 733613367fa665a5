"""The ``[cost]`` table of a machine file."""

from typing import Annotated

from simulator.cost_rates import CostRates
from simulator.files.toml_file import FileTable, quantity


class CostTable(FileTable, frozen=True, kw_only=True):
    """The ``[cost]`` table: what an hour and a worn edge cost."""

    currency: str
    rate_per_hour: Annotated[float, quantity(0.0, 1e6)]
    edge_change_s: Annotated[float, quantity(0.0, 86_400.0)]
    hss_edge_price: Annotated[float, quantity(0.0, 1e6)]
    carbide_edge_price: Annotated[float, quantity(0.0, 1e6)]
    ceramic_edge_price: Annotated[float, quantity(0.0, 1e6)]
    source: str

    @property
    def rates(self) -> CostRates:
        """Rates in canonical units."""
        return CostRates(
            currency=self.currency,
            machine_rate=self.rate_per_hour / SECONDS_PER_HOUR,
            edge_change=self.edge_change_s,
            hss_edge=self.hss_edge_price,
            carbide_edge=self.carbide_edge_price,
            ceramic_edge=self.ceramic_edge_price,
            source=self.source,
        )


SECONDS_PER_HOUR = 3600.0


def cost_table(rates: CostRates | None) -> CostTable | None:
    """Table of rates, in the units of its keys; None without rates."""
    if rates is None:
        return None
    return CostTable(
        currency=rates.currency,
        rate_per_hour=round(rates.machine_rate * SECONDS_PER_HOUR, 9),
        edge_change_s=rates.edge_change,
        hss_edge_price=rates.hss_edge,
        carbide_edge_price=rates.carbide_edge,
        ceramic_edge_price=rates.ceramic_edge,
        source=rates.source,
    )
