"""Student's t distribution with a centre and a scale, for values of unknown scatter."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class StudentT:
    """Distribution in which ``(x − centre) / scale`` follows Student's t."""

    centre: float
    scale: float
    """Scale of the distribution, above 0."""
    degrees: float
    """Degrees of freedom, above 0."""

    def __post_init__(self) -> None:
        """Check that scale and degrees of freedom are positive."""
        if not (self.scale > 0.0 and self.degrees > 0.0):
            raise ValueError(
                f"scale {self.scale} and degrees of freedom {self.degrees} must be above 0"
            )

    def quantile(self, probability: float) -> float:
        """Value below which a share of the distribution lies, the share between 0 and 1."""
        from scipy.special import stdtrit  # noqa: PLC0415 (scipy takes a fifth of a second)

        if not 0.0 < probability < 1.0:
            raise ValueError(f"probability {probability} is not between 0 and 1")
        return self.centre + self.scale * float(stdtrit(self.degrees, probability))

    def below(self, value: float) -> float:
        """Probability of a value below the given one."""
        from scipy.special import stdtr  # noqa: PLC0415 (scipy takes a fifth of a second)

        return float(stdtr(self.degrees, (value - self.centre) / self.scale))

    def between(self, low: float, high: float) -> float:
        """Probability of a value within an interval."""
        return self.below(high) - self.below(low)
