"""Units of an AP238 file, and the factors to those of ISO 14649-10 §4.2.1.

A unit is a product of powers of base units. SI units, conversion based units, derived units and
context dependent units are read; a conversion factor that is close to a defined one (degree,
inch, minute) is replaced by it, because files give only some of its digits.

References
----------
.. [1] ISO 10303-41, measure schema.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import isclose, isfinite, pi

from stepnc_model.ap238.instances import Instances, references
from stepnc_model.ap238.table import Ending, Kind
from stepnc_model.part21.values import Enumeration, Ref, Typed, Value

_PREFIXES = {
    "EXA": 1e18,
    "PETA": 1e15,
    "TERA": 1e12,
    "GIGA": 1e9,
    "MEGA": 1e6,
    "KILO": 1e3,
    "HECTO": 1e2,
    "DECA": 1e1,
    "DECI": 1e-1,
    "CENTI": 1e-2,
    "MILLI": 1e-3,
    "MICRO": 1e-6,
    "NANO": 1e-9,
    "PICO": 1e-12,
    "FEMTO": 1e-15,
    "ATTO": 1e-18,
}
_BASES = {"METRE": "length", "SECOND": "time", "RADIAN": "angle", "GRAM": "mass"}

_DEFINED = (pi / 180.0, 0.0254, 0.3048, 60.0, 3600.0, 2.0 * pi, 1e-3, 1e-6, 0.01)
_CLOSE = 1e-6
"""Relative difference up to which a conversion factor is taken for a defined one."""

_MAX_DEPTH = 8
"""Greatest number of conversions of a unit into another."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Unit:
    """Unit as a product of powers of base units."""

    exponents: Mapping[str, float] = field(default_factory=dict)
    """Exponent of each base unit; empty for a number or ratio."""
    factors: Mapping[str, float] = field(default_factory=dict)
    """Size of each base unit in SI units."""
    scale: float = 1.0
    """Factor of a unit without dimension, such as a percent."""

    def factor(self, exponents: Mapping[str, float]) -> float:
        """Size of a unit with other exponents in SI units, as far as its bases are known."""
        size = self.scale if not exponents else 1.0
        for base, exponent in exponents.items():
            size *= self.factors.get(base, _ISO_BASES[base]) ** exponent
        return size


_ISO_BASES = {"length": 1e-3, "time": 1.0, "angle": pi / 180.0, "pascal": 1.0}


@dataclass(frozen=True, slots=True, kw_only=True)
class AimMeasure:
    """Dimension of a kind of value, and its unit in ISO 14649."""

    exponents: Mapping[str, float]
    iso: float
    """Unit of ISO 14649 in SI units."""
    noun: str
    unit: str


MEASURES = {
    Kind.LENGTH: AimMeasure(exponents={"length": 1.0}, iso=1e-3, noun="a length", unit="mm"),
    Kind.ANGLE: AimMeasure(
        exponents={"angle": 1.0}, iso=pi / 180.0, noun="an angle", unit="deg"
    ),
    Kind.RATIO: AimMeasure(exponents={}, iso=1.0, noun="a ratio", unit="1"),
    Kind.COUNT: AimMeasure(exponents={}, iso=1.0, noun="a count", unit="1"),
    Kind.TIME: AimMeasure(exponents={"time": 1.0}, iso=1.0, noun="a time", unit="s"),
    Kind.SPEED: AimMeasure(
        exponents={"length": 1.0, "time": -1.0}, iso=1.0, noun="a speed", unit="m/s"
    ),
    Kind.ROTATION: AimMeasure(
        exponents={"time": -1.0}, iso=1.0, noun="a rotational speed", unit="rev/s"
    ),
    Kind.PRESSURE: AimMeasure(exponents={"pascal": 1.0}, iso=1.0, noun="a pressure", unit="Pa"),
    Kind.ROUGHNESS: AimMeasure(
        exponents={"length": 1.0}, iso=1e-6, noun="a roughness", unit="um"
    ),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Conversion:
    """Factor from a number in the file to the unit of ISO 14649."""

    factor: float
    is_fitting: bool = True
    """Whether the unit has the dimension of the value."""


def conversion(unit: Unit | None, measure: AimMeasure) -> Conversion:
    """Factor from a unit to that of ISO 14649.

    A unit of another dimension does not fit; its own bases are used as far as they go, because
    writers give feeds per tooth and speed limits in the unit of the feed.

    Parameters
    ----------
    unit : Unit, optional
        None: the unit of ISO 14649.
    measure : AimMeasure
    """
    if unit is None:
        return Conversion(factor=1.0)
    wanted = dict(measure.exponents)
    given = {base: power for base, power in unit.exponents.items() if power}
    if measure.unit == "rev/s" and given == {"time": -1.0, "angle": 1.0}:
        size = unit.factor(given) / (2.0 * pi)
        return Conversion(factor=size)
    if given != wanted and measure.unit == "Pa":
        return Conversion(factor=1.0, is_fitting=False)
    factor = unit.factor(wanted) / measure.iso
    return Conversion(factor=factor, is_fitting=given == wanted)


class Units:
    """Units of one file.

    The object has state: units are cached once read.

    Parameters
    ----------
    instances : Instances
    """

    def __init__(self, instances: Instances) -> None:
        self._instances = instances
        self._known: dict[int, Unit | None] = {}
        self._lengths: dict[int, Unit | None] = {}
        self._default: Unit | None = None
        self._has_default = False

    def unit(self, id: int) -> Unit | None:
        """Unit of an instance; None if it is not a unit that is known."""
        if id not in self._known:
            self._known[id] = self._read(id, 0)
        return self._known[id]

    def length_in(self, context: int | None) -> Unit | None:
        """Unit of length of a representation context, or of the file where it has none."""
        if context is not None:
            if context not in self._lengths:
                self._lengths[context] = self._length(context)
            found = self._lengths[context]
            if found is not None:
                return found
        if not self._has_default:
            contexts = self._instances.of_entity("GLOBAL_UNIT_ASSIGNED_CONTEXT")
            lengths = (self._length(id) for id in contexts)
            self._default = next((unit for unit in lengths if unit is not None), None)
            self._has_default = True
        return self._default

    def name(self, id: int) -> str:
        """Name that a file gives to a unit; empty if it gives none."""
        for other in self._instances.referrers(id, "NAME_ATTRIBUTE", "named_item"):
            value = self._instances.value(other, "attribute_value")
            if isinstance(value, str):
                return value
        value = self._instances.value(id, "name")
        if isinstance(value, Enumeration):
            prefix = self._instances.value(id, "prefix")
            return f"{prefix or ''}{value}".lower()  # MILLI and METRE: millimetre
        return value if isinstance(value, str) else ""

    def _length(self, context: int) -> Unit | None:
        """Unit of length among those of a context."""
        units = (
            self.unit(int(ref))
            for value in self._instances.values(context, "units")
            for ref in references(value)
        )
        return next(
            (unit for unit in units if unit and unit.exponents == {"length": 1.0}), None
        )

    def _read(self, id: int, depth: int) -> Unit | None:
        """Read a unit; None if it is none, or if it refers to itself."""
        if depth > _MAX_DEPTH or id not in self._instances:
            return None
        instances = self._instances
        if instances.is_a(id, "SI_UNIT"):
            return _si_unit(instances.value(id, "prefix"), instances.values(id, "name"))
        if instances.is_a(id, "CONVERSION_BASED_UNIT"):
            return self._conversion_based(id, depth)
        if instances.is_a(id, "DERIVED_UNIT"):
            return self._derived(id, depth)
        if instances.is_a(id, "CONTEXT_DEPENDENT_UNIT") or instances.is_a(id, "RATIO_UNIT"):
            return Unit()
        return None

    def _conversion_based(self, id: int, depth: int) -> Unit | None:
        """Unit that is a multiple of another."""
        measure = self._instances.value(id, "conversion_factor")
        if not isinstance(measure, Ref):
            return None
        number = number_of(self._instances.value(int(measure), "value_component"))
        inner = self._instances.value(int(measure), "unit_component")
        unit = self._read(int(inner), depth + 1) if isinstance(inner, Ref) else None
        if unit is None or number is None or number <= 0.0 or len(unit.exponents) > 1:
            return None
        if not unit.exponents:
            return Unit(scale=unit.scale * _defined(number))
        (base,) = unit.exponents
        size = unit.factors.get(base, 1.0) * number
        return Unit(exponents=unit.exponents, factors={base: _defined(size)})

    def _derived(self, id: int, depth: int) -> Unit | None:
        """Product of powers of units."""
        exponents: dict[str, float] = {}
        factors: dict[str, float] = {}
        scale = 1.0
        for value in self._instances.values(id, "elements"):
            for element in references(value):
                inner = self._instances.value(int(element), "unit")
                power = number_of(self._instances.value(int(element), "exponent"))
                unit = self._read(int(inner), depth + 1) if isinstance(inner, Ref) else None
                if unit is None or power is None:
                    return None
                scale *= unit.scale**power
                factors |= unit.factors
                for base, exponent in unit.exponents.items():
                    exponents[base] = exponents.get(base, 0.0) + exponent * power
        return Unit(exponents=exponents, factors=factors, scale=scale)


def number_of(value: Value) -> float | None:
    """Number in a plain or typed value; None if there is none."""
    while isinstance(value, Typed):
        value = value.value
    if isinstance(value, (Ref, bool)) or not isinstance(value, int | float):
        return None
    return value if isfinite(value) else None


def _si_unit(prefix: Value, names: tuple[Value, ...]) -> Unit | None:
    """SI unit of a prefix and a name."""
    name = str(names[-1]) if names and names[-1] is not None else ""
    if not name:
        return None
    factor = _PREFIXES.get(str(prefix), 1.0) if prefix is not None else 1.0
    base = _BASES.get(name, name.lower())
    if name == "HERTZ":
        return Unit(exponents={"time": -1.0}, factors={"time": 1.0 / factor})
    return Unit(exponents={base: 1.0}, factors={base: factor})


def _defined(factor: float) -> float:
    """Defined factor that a factor with fewer digits stands for, else the factor itself."""
    near = (known for known in _DEFINED if isclose(factor, known, rel_tol=_CLOSE))
    return next(near, factor)


_MEASURE_OF: Mapping[Kind, Kind] = {
    Kind.LENGTH: Kind.LENGTH,
    Kind.LENGTHS: Kind.LENGTH,
    Kind.OWN_LENGTH: Kind.LENGTH,
    Kind.RADIUS: Kind.LENGTH,
    Kind.WRITTEN: Kind.LENGTH,
    Kind.ANGLE: Kind.ANGLE,
    Kind.LIP_ANGLE: Kind.ANGLE,
    Kind.RATIO: Kind.RATIO,
    Kind.PROFILE: Kind.RATIO,
    Kind.COUNT: Kind.COUNT,
    Kind.TIME: Kind.TIME,
    Kind.SPEED: Kind.SPEED,
    Kind.ROTATION: Kind.ROTATION,
    Kind.PRESSURE: Kind.PRESSURE,
    Kind.ROUGHNESS: Kind.ROUGHNESS,
}


def is_measured(kind: Kind) -> bool:
    """True if a kind of value is a number with a unit that is converted."""
    return kind in _MEASURE_OF and kind is not Kind.WRITTEN


def measure_kind(ending: Ending) -> Kind:
    """Kind of measure that an ending gives, in the units of ``MEASURES``."""
    return ending.measure if ending.kind is Kind.TYPED else _MEASURE_OF[ending.kind]
