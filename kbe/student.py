"""Student's t with a centre and a scale: what is believed of a number with unknown scatter."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class StudentT:
    """``(x − centre) / scale`` follows Student's t."""

    centre: float
    scale: float
    """above 0"""
    degrees: float
    """of freedom, above 0"""

    def __post_init__(self) -> None:
        """Refuse what is no distribution."""
        if not (self.scale > 0.0 and self.degrees > 0.0):
            raise ValueError(
                f"scale {self.scale} and degrees of freedom {self.degrees} must be above 0"
            )

    def quantile(self, probability: float) -> float:
        """The value that lies above a share of the distribution, between 0 and 1."""
        from scipy.special import stdtrit  # noqa: PLC0415 (scipy takes a fifth of a second)

        if not 0.0 < probability < 1.0:
            raise ValueError(f"probability {probability} is not between 0 and 1")
        return self.centre + self.scale * float(stdtrit(self.degrees, probability))

    def below(self, value: float) -> float:
        """Probability of less than a value."""
        from scipy.special import stdtr  # noqa: PLC0415 (scipy takes a fifth of a second)

        return float(stdtr(self.degrees, (value - self.centre) / self.scale))

    def between(self, low: float, high: float) -> float:
        """Probability of a value within an interval."""
        return self.below(high) - self.below(low)
