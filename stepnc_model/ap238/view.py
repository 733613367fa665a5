"""An AP238 file seen as a program of ISO 14649.

The view is a Part 21 file in memory whose instances are those of ISO 14649. Its instance
numbers, lines and findings are those of the AP238 file, so that whatever reads a program of ISO
14649 reads an AP238 program too, and names the right places of it.
"""

from collections.abc import Collection, Iterable
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import isclose
from typing import Self

from stepnc_model.ap238.body_transfer import BODY, carried, with_bodies
from stepnc_model.ap238.quantity import MEASURES, conversion, is_measured, measure_kind
from stepnc_model.ap238.reading import AimReader
from stepnc_model.ap238.reference_paths import Place
from stepnc_model.ap238.table import Converted, ConvertedText, Kind
from stepnc_model.errors import Finding
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.writer import described_as

SCHEMAS = ("MODEL_BASED_INTEGRATED_MANUFACTURING_SCHEMA", "INTEGRATED_CNC_SCHEMA")
"""Schemas of AP238: of its second and later editions, and of the first."""

MARKS = (
    "MACHINING_WORKPLAN",
    "MACHINING_PROJECT",
    "MACHINING_WORKINGSTEP",
    "MACHINING_TOOLPATH",
)
"""Entities that make a file an AP238 program, where no workplan of ISO 14649 is in it."""


_ROTATIONS = ("spindle", "rot_speed", "max_speed")
_SPINDLE_UNITS = {"rpm": 1.0 / 60.0, "rev/s": 1.0}
_FEED_UNITS = {
    "mm/min": 1e-3 / 60.0,
    "mm/s": 1e-3,
    "m/s": 1.0,
    "m/min": 1.0 / 60.0,
    "inch/min": 0.0254 / 60.0,
    "feet/min": 0.3048 / 60.0,
}
"""Units of feeds and speeds by their usual names, in m/s."""


def is_aim(file: Part21File) -> bool:
    """True if a file is an AP238 program, judged by its instances and not by its schema."""
    workplans = file.ids_of("MACHINING_WORKPLAN") or file.ids_of("MACHINING_PROJECT")
    if workplans:
        return True
    if not any(file.ids_of(name) for name in MARKS):
        return False
    return not file.ids_of("WORKPLAN") and bool(file.ids_of("ACTION_PROPERTY"))


@dataclass(frozen=True, kw_only=True, eq=False)
class AimView(Part21File):
    """Instances of ISO 14649 that an AP238 file describes.

    The class has no slots, as its base has none.
    """

    source: Part21File
    """AP238 file as it was read."""
    read: Part21File
    """Instances of ISO 14649 as they were read, without later changes."""
    origins: dict[int, Converted] = field(default_factory=dict)
    """What each instance was converted from, by its number."""
    remarks: tuple[Finding, ...] = ()
    """Deviations met during the conversion."""

    @classmethod
    def of(cls, source: Part21File) -> Self:
        """Convert an AP238 file."""
        reading = AimReader(source).read()
        text = _text(source, reading.converted)
        origins = {each.instance.number: each.instance for each in reading.converted}
        reading.converted.clear()
        plain = Part21File.from_bytes(text, name=source.name)
        return cls(
            data=plain.data,
            name=source.name,
            structure=plain.structure,
            source=source,
            read=plain,
            origins=origins,
            remarks=reading.findings,
        )

    def with_bodies(self) -> tuple[bytes, tuple[Finding, ...]]:
        """Bytes of the program of ISO 14649 with the B-rep bodies, and what is left out."""
        roots = (
            (each.origin, number)
            for number, each in self.origins.items()
            if each.keyword == BODY
        )
        bodies = carried(self.source, roots)
        return with_bodies(self.data, bodies), bodies.findings

    def changed(
        self, text: Part21File, settled: Collection[tuple[str, str]] = frozenset()
    ) -> Self:
        """The view with changed text, which is written with the next changes of the file.

        Parameters
        ----------
        text : Part21File
        settled : collection of (str, str)
            Instances, as messages name them, and their attributes whose faults are mended.
        """
        remarks = tuple(
            each for each in self.remarks if (each.entity, each.attribute) not in settled
        )
        return replace(self, data=text.data, structure=text.structure, remarks=remarks)

    def remembering(self, origins: Iterable[Converted]) -> Self:
        """The view with instances that stand for others of the file, by their numbers."""
        return replace(self, origins=self.origins | {each.number: each for each in origins})

    def number_of(self, origin: Converted) -> int | None:
        """Number of the instance for which the same AIM instance stands as in another view."""
        alike = (
            number
            for number, each in self.origins.items()
            if (each.origin, each.keyword) == (origin.origin, origin.keyword)
        )
        return next(alike, None)

    def factor(self, number: int, attribute: str) -> float | None:
        """Factor from a number in the AP238 file to that of ISO 14649.

        Where the file gives no number there, that of the same attribute of another instance;
        None: an attribute that has no number of its own, or whose unit is not known.
        """
        each = self.origins.get(number)
        if each is None or each.rule is None:
            return None
        own = self._own_factor(each, attribute)
        if own is not None:
            return own
        alike = (other for other in self.origins.values() if other.keyword == each.keyword)
        found = (self._own_factor(other, attribute) for other in alike)
        return next((factor for factor in found if factor is not None), None)

    def number_unit(self, number: int, attribute: str) -> str:
        """Usual name of the unit of a number in the AP238 file; empty: it has none."""
        factor = self.factor(number, attribute)
        if factor is None:
            return ""
        names = _SPINDLE_UNITS if attribute in _ROTATIONS else _FEED_UNITS
        return next(
            (name for name, size in names.items() if isclose(size, factor, rel_tol=1e-6)), ""
        )

    def _own_factor(self, each: Converted, attribute: str) -> float | None:
        """Factor of a number that the file gives."""
        rows = () if each.rule is None else each.rule.rows
        start = Place(id=each.origin, context=each.context, way=(each.origin,))
        for row in rows:
            if row.attribute != attribute:
                continue
            for path in row.paths:
                kind = path.ending.kind
                for place in self._reader.follow(start, path.steps):
                    if kind is Kind.COORDINATES:
                        return self._reader.geometry_factor(place.context)
                    if is_measured(kind):
                        measure = MEASURES[measure_kind(path.ending)]
                        return conversion(self._reader.unit_of(place), measure).factor
        return None

    @cached_property
    def _reader(self) -> AimReader:
        """Reader that follows the paths of the file."""
        return AimReader(self.source)

    def line(self, id: int) -> int:
        """Line of the AP238 file on which the instance begins."""
        found = self.origins.get(id)
        return super().line(id) if found is None else self.source.line(found.origin)

    def label(self, id: int) -> str:
        """Name of an instance in messages: its number in the AP238 file and its entity."""
        found = self.origins.get(id)
        if found is None:
            return super().label(id)
        if found.rule is None:
            return self.source.label(found.origin)
        return f"#{found.origin} {found.keyword}"

    @cached_property
    def findings(self) -> tuple[Finding, ...]:
        """Deviations of the AP238 file from the syntax, and from its reference paths."""
        return self.source.findings + self.remarks


def _text(source: Part21File, converted: list[ConvertedText]) -> bytes:
    """File of ISO 14649 with the description and the name of the source."""
    lines = (each.line for each in converted)
    return described_as(source, ("MACHINING_SCHEMA", "MILLING_SCHEMA", "TURNING_SCHEMA"), lines)
