"""Parser of ``--disturb`` words such as ``depth:+50%@12s``, one disturbance each.

=================  =====================================================================
word               meaning
=================  =====================================================================
depth:+50%@12s     axial depth, relative to the program, from a time on
hardness:+30%@12s  k_c, relative to the start, from a time on
material:NAME@12s  another material of the library, from a time on
tooth:1@12s        the tooth with this number breaks
silence:2s@12s     no samples arrive for this duration
line:off@12s       the connection to the machine breaks
kc:1.3             factor on k_c from the start
wear:0.05mm/min    flank wear per minute of cutting
runout:20um        eccentricity of the cutter
lag:60ms           time constant with which the feed follows the override
noise:3%           noise of the dynamometer
drift:1N/s         zero drift of the dynamometer
missing:5%         share of the dynamometer's samples that is lost
override:80%@12s   the axes run this override, whatever is commanded
readings:20ms      mean force over such a time in place of tooth periods
jitter:10%         greatest deviation of that time
power:-50%@12s     motor power that the operator allows, relative to the machine's
mode:QC@12s        the operator switches to TC or QC
control:off@12s    the operator switches the loop on or off
=================  =====================================================================
"""

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from math import isfinite
from typing import Any

from controller.orders import Criterion, CriterionTo, MotorPowerTo, Order, SwitchTo
from simulator.plant.controlled_machine import Instrumentation
from simulator.plant.hidden_behaviour import HiddenChange, HiddenQuantity, HiddenTruth
from stepnc_model.errors import StepNcError

WORD = re.compile(r"(?P<what>[a-z]+):(?P<value>[^@]*)(?:@(?P<time>[^@]*))?")
NUMBER = re.compile(
    r"(?P<number>[+-]?[0-9.]+(?:e[+-]?[0-9]+)?)(?P<unit>[^0-9.]*)", re.IGNORECASE
)

MOST_FACTOR = 10.0
"""Largest factor on depth, k_c or power; a larger one is taken for a typing error."""

MOST_TEETH = 100.0

LONGEST_READING = 1.0
"""Longest time between readings, in s."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TimedOrder:
    """Order that the operator gives at a set time."""

    time: float
    """Time in the run, in s."""
    order: Order


@dataclass(frozen=True, slots=True, kw_only=True)
class Disturbances:
    """Hidden changes, sensor errors and operator orders that the plan does not know."""

    hidden: HiddenTruth = field(default_factory=HiddenTruth)
    bench: Instrumentation = field(default_factory=Instrumentation)
    orders: tuple[TimedOrder, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class _Word:
    text: str
    value: str
    time: float | None


def disturbances(words: Iterable[str], *, hardness: Callable[[str], float]) -> Disturbances:
    """Parse disturbance words into disturbances and operator orders.

    Parameters
    ----------
    hardness : callable
        Function that returns a material's k_c relative to that of the workpiece.

    Raises
    ------
    StepNcError
        When a word is not in the table above, or exceeds its bounds.
    """
    found = Disturbances()
    for word in words:
        found = _with(found, word, hardness)
    by_time = tuple(sorted(found.orders, key=lambda each: each.time))
    return replace(found, orders=by_time)


def time_of(word: str) -> float | None:
    """Time at which a disturbance begins, in s; None: it holds from the start.

    Raises
    ------
    StepNcError
        When the word cannot be parsed.
    """
    return _split(word)[1].time


def _with(
    disturbances: Disturbances, text: str, hardness: Callable[[str], float]
) -> Disturbances:
    what, word = _split(text)
    if what in _FROM_START:
        if word.time is not None:
            raise StepNcError(f"disturbance '{text}': it holds from the start; remove '@…'")
        return _FROM_START[what](disturbances, word)
    if what in _ORDERS:
        order = TimedOrder(time=_time(word), order=_ORDERS[what](word))
        return replace(disturbances, orders=(*disturbances.orders, order))
    if what == "material":
        change = HiddenChange(
            time=_time(word), what=HiddenQuantity.HARDNESS, value=hardness(word.value)
        )
    elif what in _CHANGES:
        kind, value = _CHANGES[what]
        change = HiddenChange(time=_time(word), what=kind, value=value(word))
    else:
        known = ", ".join(sorted({*_FROM_START, *_ORDERS, *_CHANGES, "material"}))
        raise StepNcError(f"disturbance '{text}': unknown kind '{what}'; known: {known}")
    hidden = replace(disturbances.hidden, changes=(*disturbances.hidden.changes, change))
    return replace(disturbances, hidden=hidden)


def _split(text: str) -> tuple[str, _Word]:
    match = WORD.fullmatch(text.strip())
    if match is None:
        raise StepNcError(f"disturbance '{text}': write it like depth:+50%@12s or kc:1.3")
    time = match["time"]
    at = None if time is None else _number(text, time, {"s": 1.0, "": 1.0, "min": 60.0})
    if at is not None and at < 0.0:
        raise StepNcError(f"disturbance '{text}': the time must be at least 0 s")
    return match["what"], _Word(text=text, value=match["value"], time=at)


def _time(word: _Word) -> float:
    if word.time is None:
        raise StepNcError(f"disturbance '{word.text}': add a time, as in {word.text}@12s")
    return word.time


def _number(text: str, value: str, units: dict[str, float]) -> float:
    """Parse a number with one of several units; return it in the first unit."""
    match = NUMBER.fullmatch("".join(value.split()))
    if match is None or match["unit"] not in units:
        known = " or ".join(unit for unit in units if unit)
        unit = f" in {known}" if known else ""
        raise StepNcError(f"disturbance '{text}': '{value}' is not a number{unit}")
    try:
        number = float(match["number"]) * units[match["unit"]]
    except ValueError:
        number = float("nan")
    if not isfinite(number):
        raise StepNcError(f"disturbance '{text}': '{value}' is not a number")
    return number


def _within(word: _Word, units: dict[str, float], low: float, high: float) -> float:
    value = _number(word.text, word.value, units)
    if not low <= value <= high:
        unit, scale = next(iter(units.items()))
        bound = f"{low / scale:g} to {high / scale:g} {unit}".rstrip()
        raise StepNcError(f"disturbance '{word.text}': it must be {bound}")
    return value


def _factor(word: _Word) -> float:
    """Parse ``+50%`` or a plain factor into a factor."""
    if word.value.endswith("%"):
        if not word.value.startswith(("+", "-")):
            way = "add a sign, as in +50% or -50%"
            raise StepNcError(f"disturbance '{word.text}': {way}")
        factor = 1.0 + 0.01 * _number(word.text, word.value, {"%": 1.0})
    else:
        factor = _number(word.text, word.value, {"": 1.0})
    if not 0.0 < factor <= MOST_FACTOR:
        bound = f"above -100 % and at most {100.0 * (MOST_FACTOR - 1.0):+g} %"
        raise StepNcError(f"disturbance '{word.text}': it must be {bound}")
    return factor


def _share(word: _Word) -> float:
    return _within(word, {"%": 0.01}, 0.0, 0.99)


def _tooth(word: _Word) -> float:
    number = _within(word, {"": 1.0}, 1.0, MOST_TEETH)
    if not number.is_integer():
        raise StepNcError(f"disturbance '{word.text}': tooth numbers are 1, 2, 3 …")
    return number - 1.0


def _line(word: _Word) -> float:
    if word.value != "off":
        raise StepNcError(f"disturbance '{word.text}': the value must be 'off'")
    return 0.0


def _power(word: _Word) -> Order:
    return MotorPowerTo(factor=_factor(word))


def _mode(word: _Word) -> Order:
    try:
        return CriterionTo(criterion=Criterion(word.value.upper()))
    except ValueError:
        raise StepNcError(f"disturbance '{word.text}': the mode must be TC or QC") from None


def _switch(word: _Word) -> Order:
    if word.value not in {"on", "off"}:
        raise StepNcError(f"disturbance '{word.text}': control must be 'on' or 'off'")
    return SwitchTo(is_on=word.value == "on")


def _hidden(name: str, read: Callable[[_Word], float]) -> Callable[..., Disturbances]:
    def with_it(disturbances: Disturbances, word: _Word) -> Disturbances:
        change: dict[str, Any] = {name: read(word)}
        return replace(disturbances, hidden=replace(disturbances.hidden, **change))

    return with_it


def _bench(name: str, read: Callable[[_Word], float]) -> Callable[..., Disturbances]:
    def with_it(disturbances: Disturbances, word: _Word) -> Disturbances:
        change: dict[str, Any] = {name: read(word)}
        return replace(disturbances, bench=replace(disturbances.bench, **change))

    return with_it


def _instrument(name: str, read: Callable[[_Word], float]) -> Callable[..., Disturbances]:
    def with_it(disturbances: Disturbances, word: _Word) -> Disturbances:
        dynamometer = replace(disturbances.bench.dynamometer, **{name: read(word)})
        return replace(disturbances, bench=replace(disturbances.bench, dynamometer=dynamometer))

    return with_it


_FROM_START: dict[str, Callable[[Disturbances, _Word], Disturbances]] = {
    "kc": _hidden("force_factor", _factor),
    "wear": _hidden("wear_rate", lambda word: _within(word, {"mm/min": 1.0}, 0.0, 1.0) / 60.0),
    "runout": _hidden(
        "eccentricity",
        lambda word: _within(word, {"um": 1e-3, "µm": 1e-3, "μm": 1e-3}, 0.0, 0.5),
    ),
    "lag": _hidden("servo_lag", lambda word: _within(word, {"ms": 1e-3, "s": 1.0}, 1e-3, 10.0)),
    "noise": _instrument("noise", _share),
    "readings": _bench(
        "reading_period",
        lambda word: _within(word, {"ms": 1e-3, "s": 1.0}, 1e-4, LONGEST_READING),
    ),
    "jitter": _bench("jitter", _share),
    "drift": _instrument("drift", lambda word: _within(word, {"N/s": 1.0}, -1e3, 1e3)),
    "missing": _instrument("missing", _share),
}
_CHANGES: dict[str, tuple[HiddenQuantity, Callable[[_Word], float]]] = {
    "depth": (HiddenQuantity.DEPTH, _factor),
    "hardness": (HiddenQuantity.HARDNESS, _factor),
    "tooth": (HiddenQuantity.TOOTH, _tooth),
    "override": (
        HiddenQuantity.OVERRIDE,
        lambda word: _within(word, {"%": 0.01}, 0.0, 2.0),
    ),
    "line": (HiddenQuantity.LINE, _line),
    "silence": (
        HiddenQuantity.SILENCE,
        lambda word: _within(word, {"s": 1.0, "ms": 1e-3}, 1e-3, 1e4),
    ),
}
_ORDERS: dict[str, Callable[[_Word], Order]] = {
    "power": _power,
    "mode": _mode,
    "control": _switch,
}
