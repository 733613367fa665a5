"""Carbon dioxide emission of electric energy, by a stated factor. Units J, g.

References
----------
.. [1] Ember, "Global Electricity Review 2024": 480 g/kWh, world average of 2023, including the
   effects of other gases and of the construction of plants and supply of fuel.
"""

from dataclasses import dataclass

from stepnc_model.errors import StepNcError

JOULES_PER_KILOWATT_HOUR = 3.6e6


@dataclass(frozen=True, slots=True, kw_only=True)
class CarbonFactor:
    """Carbon dioxide emission per kilowatt-hour from the mains.

    Raises
    ------
    ValueError
        When the factor is negative or not a number.
    """

    grams_per_kwh: float
    source: str

    def __post_init__(self) -> None:
        if not 0.0 <= self.grams_per_kwh < float("inf"):
            raise ValueError(f"carbon factor {self.grams_per_kwh:g} g/kWh must be at least 0")

    def grams(self, energy: float) -> float:
        """Return the carbon dioxide emission of an energy in J, in g."""
        return kilowatt_hours(energy) * self.grams_per_kwh


def stated(grams_per_kwh: float) -> CarbonFactor:
    """Build a carbon factor from a user's value.

    Raises
    ------
    StepNcError
        When the value is negative or not a number.
    """
    try:
        return CarbonFactor(grams_per_kwh=grams_per_kwh, source="as requested")
    except ValueError as error:
        raise StepNcError(str(error)) from error


def kilowatt_hours(energy: float) -> float:
    """Convert an energy from J to kWh."""
    return energy / JOULES_PER_KILOWATT_HOUR


WORLD = CarbonFactor(
    grams_per_kwh=480.0,
    source="Ember, Global Electricity Review 2024, world average of 2023",
)
"""World average, [1]_."""
