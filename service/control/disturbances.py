"""Parser of ``--disturb``: ``depth:+50%@12s``, one disturbance a word.

=================  =====================================================================
word               meaning
=================  =====================================================================
depth:+50%@12s     axial depth, against the program's, from a time on
hardness:+30%@12s  k_c, against the start, from a time on
material:NAME@12s  another material of the library, from a time on
tooth:1@12s        that tooth breaks
silence:2s@12s     no sample arrives for so long
line:off@12s       the line to the machine breaks
kc:1.3             factor on k_c from the start
wear:0.05mm/min    flank wear in a minute of cutting
runout:20um        eccentricity of the cutter
lag:60ms           time constant with which the feed follows the override
noise:3%           of the dynamometer
drift:1N/s         of its zero
missing:5%         share of its samples that is lost
power:-50%@12s     motor power that the operator allows, against the machine's
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
from simulator.plant.controlled import Instrumentation
from simulator.plant.hidden import HiddenChange, HiddenQuantity, HiddenTruth
from stepnc_model.errors import StepNcError

WORD = re.compile(r"(?P<what>[a-z]+):(?P<value>[^@]*)(?:@(?P<time>[^@]*))?")
NUMBER = re.compile(
    r"(?P<number>[+-]?[0-9.]+(?:e[+-]?[0-9]+)?)(?P<unit>[^0-9.]*)", re.IGNORECASE
)

MOST_FACTOR = 10.0
"""on depth, k_c or power; more is a slip"""

MOST_TEETH = 100.0


@dataclass(frozen=True, slots=True, kw_only=True)
class TimedOrder:
    """Order of the operator at a time."""

    time: float
    """s of the run"""
    order: Order


@dataclass(frozen=True, slots=True, kw_only=True)
class Disturbances:
    """All that the plan does not know."""

    hidden: HiddenTruth = field(default_factory=HiddenTruth)
    bench: Instrumentation = field(default_factory=Instrumentation)
    orders: tuple[TimedOrder, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class _Word:
    text: str
    value: str
    time: float | None


def disturbances(words: Iterable[str], *, hardness: Callable[[str], float]) -> Disturbances:
    """Disturbances and orders of all words.

    Parameters
    ----------
    words : iterable of str
    hardness : callable
        k_c of a material by its name, over that of the one that is cut.

    Raises
    ------
    StepNcError
        When a word is not one of those above, with its bounds.
    """
    found = Disturbances()
    for word in words:
        found = _with(found, word, hardness)
    by_time = tuple(sorted(found.orders, key=lambda each: each.time))
    return replace(found, orders=by_time)


def time_of(word: str) -> float | None:
    """Time of a word's disturbance, s; None: it holds from the start.

    Raises
    ------
    StepNcError
        When it is no word of the grammar.
    """
    return _split(word)[1].time


def _with(found: Disturbances, text: str, hardness: Callable[[str], float]) -> Disturbances:
    what, word = _split(text)
    if what in _FROM_START:
        if word.time is not None:
            raise StepNcError(f"disturbance '{text}': it holds from the start, without '@'")
        return _FROM_START[what](found, word)
    if what in _ORDERS:
        order = TimedOrder(time=_time(word), order=_ORDERS[what](word))
        return replace(found, orders=(*found.orders, order))
    if what == "material":
        change = HiddenChange(
            time=_time(word), what=HiddenQuantity.HARDNESS, value=hardness(word.value)
        )
    elif what in _CHANGES:
        kind, value = _CHANGES[what]
        change = HiddenChange(time=_time(word), what=kind, value=value(word))
    else:
        known = ", ".join(sorted({*_FROM_START, *_ORDERS, *_CHANGES, "material"}))
        raise StepNcError(f"disturbance '{text}': '{what}' is not one of {known}")
    hidden = replace(found.hidden, changes=(*found.hidden.changes, change))
    return replace(found, hidden=hidden)


def _split(text: str) -> tuple[str, _Word]:
    match = WORD.fullmatch(text.strip())
    if match is None:
        raise StepNcError(f"disturbance '{text}': write it as depth:+50%@12s or kc:1.3")
    time = match["time"]
    at = None if time is None else _number(text, time, {"s": 1.0, "": 1.0, "min": 60.0})
    if at is not None and at < 0.0:
        raise StepNcError(f"disturbance '{text}': the time must be at least 0 s")
    return match["what"], _Word(text=text, value=match["value"], time=at)


def _time(word: _Word) -> float:
    if word.time is None:
        raise StepNcError(f"disturbance '{word.text}': say when, as in {word.text}@12s")
    return word.time


def _number(text: str, value: str, units: dict[str, float]) -> float:
    """A number in one of some units, in the first's."""
    match = NUMBER.fullmatch("".join(value.split()))
    if match is None or match["unit"] not in units:
        known = " or ".join(unit for unit in units if unit)
        unit = f" in {known}" if known else ""
        raise StepNcError(f"disturbance '{text}': '{value}' is no number{unit}")
    try:
        number = float(match["number"]) * units[match["unit"]]
    except ValueError:
        number = float("nan")
    if not isfinite(number):
        raise StepNcError(f"disturbance '{text}': '{value}' is no number")
    return number


def _within(word: _Word, units: dict[str, float], low: float, high: float) -> float:
    value = _number(word.text, word.value, units)
    if not low <= value <= high:
        unit, scale = next(iter(units.items()))
        bound = f"{low / scale:g} to {high / scale:g} {unit}".rstrip()
        raise StepNcError(f"disturbance '{word.text}': it must be {bound}")
    return value


def _factor(word: _Word) -> float:
    """``+50%`` or a plain factor."""
    if word.value.endswith("%"):
        if not word.value.startswith(("+", "-")):
            way = "say which way, as in +50% or -50%"
            raise StepNcError(f"disturbance '{word.text}': {way}")
        factor = 1.0 + 0.01 * _number(word.text, word.value, {"%": 1.0})
    else:
        factor = _number(word.text, word.value, {"": 1.0})
    if not 0.0 < factor <= MOST_FACTOR:
        bound = f"above -100 % and {100.0 * (MOST_FACTOR - 1.0):+g} % at most"
        raise StepNcError(f"disturbance '{word.text}': it must be {bound}")
    return factor


def _share(word: _Word) -> float:
    return _within(word, {"%": 0.01}, 0.0, 0.99)


def _tooth(word: _Word) -> float:
    number = _within(word, {"": 1.0}, 1.0, MOST_TEETH)
    if not number.is_integer():
        raise StepNcError(f"disturbance '{word.text}': teeth are counted 1, 2, 3")
    return number - 1.0


def _line(word: _Word) -> float:
    if word.value != "off":
        raise StepNcError(f"disturbance '{word.text}': the line can only go off")
    return 0.0


def _power(word: _Word) -> Order:
    return MotorPowerTo(factor=_factor(word))


def _mode(word: _Word) -> Order:
    try:
        return CriterionTo(criterion=Criterion(word.value.upper()))
    except ValueError:
        raise StepNcError(f"disturbance '{word.text}': the mode is TC or QC") from None


def _switch(word: _Word) -> Order:
    if word.value not in {"on", "off"}:
        raise StepNcError(f"disturbance '{word.text}': control is on or off")
    return SwitchTo(is_on=word.value == "on")


def _hidden(name: str, read: Callable[[_Word], float]) -> Callable[..., Disturbances]:
    def with_it(found: Disturbances, word: _Word) -> Disturbances:
        change: dict[str, Any] = {name: read(word)}
        return replace(found, hidden=replace(found.hidden, **change))

    return with_it


def _instrument(name: str, read: Callable[[_Word], float]) -> Callable[..., Disturbances]:
    def with_it(found: Disturbances, word: _Word) -> Disturbances:
        dynamometer = replace(found.bench.dynamometer, **{name: read(word)})
        return replace(found, bench=replace(found.bench, dynamometer=dynamometer))

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
    "drift": _instrument("drift", lambda word: _within(word, {"N/s": 1.0}, -1e3, 1e3)),
    "missing": _instrument("missing", _share),
}
_CHANGES: dict[str, tuple[HiddenQuantity, Callable[[_Word], float]]] = {
    "depth": (HiddenQuantity.DEPTH, _factor),
    "hardness": (HiddenQuantity.HARDNESS, _factor),
    "tooth": (HiddenQuantity.TOOTH, _tooth),
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
