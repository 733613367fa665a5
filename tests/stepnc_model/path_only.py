"""AP238 program in the manner of a CAM post: a tool by its name, tool paths, no features."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

HEAD = (
    "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\n"
    "FILE_NAME('','2026-01-01T00:00:00',(''),(''),'','','');\n"
    "FILE_SCHEMA(('INTEGRATED_CNC_SCHEMA'));\nENDSEC;\nDATA;\n"
)

Point = tuple[float, float, float]


@dataclass(frozen=True)
class PathText:
    """Tool path of the program; without points, an arc in a vendor's property."""

    points: Sequence[Point] = ()
    feed: float | None = None
    """Feed, mm/min; None for a rapid."""
    arc: str = ""


FACE = (
    PathText([(-60.0, 0.0, 5.0), (-60.0, 0.0, 5.0)]),
    PathText([(-60.0, 0.0, 5.0), (-60.0, 0.0, -1.0)], 900.0),
    PathText([(-60.0, 0.0, -1.0), (60.0, 0.0, -1.0)], 300.0),
    PathText(
        feed=300.0,
        arc='{"start":[60,0,-1],"end":[60,20,-1],"center":[60,10,-1],"plane":"XY",'
        '"clockwise":false,"sweepRadians":3.141592653589793,"axialRise":0}',
    ),
    PathText([(60.0, 20.0, -1.0), (-60.0, 20.0, -1.0)], 300.0),
    PathText([(-60.0, 20.0, -1.0), (-60.0, 20.0, 5.0)]),
)
"""Two passes over a face, joined by an arc."""


@dataclass
class _Text:
    """Instances of a file with their numbers."""

    lines: list[str] = field(default_factory=list)

    def add(self, text: str) -> str:
        self.lines.append(f"#{len(self.lines) + 1}={text};")
        return f"#{len(self.lines)}"

    def prop(self, owner: str, name: str, kind: str, items: str, context: str) -> None:
        shown = self.add(f"{kind}('',({items}),{context})")
        given = self.add(f"ACTION_PROPERTY('{name}','',{owner})")
        self.add(f"ACTION_PROPERTY_REPRESENTATION('','',{given},{shown})")


def path_only_text(
    paths: Sequence[PathText] = FACE, *, operation: str = "MILLING_TYPE_OPERATION"
) -> str:
    """Text of the program; each path has a technology of its own, the operation one without a
    feed.
    """
    text = _Text()
    mm, rpm, mm_min = _units(text)
    context = text.add(
        f"(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT(({mm}))"
        "REPRESENTATION_CONTEXT('','3D'))"
    )
    scope = text.add("APPLICATION_CONTEXT('')")
    machining = text.add(f"PRODUCT_CONTEXT('',{scope},'manufacturing')")
    stage = text.add(f"PRODUCT_DEFINITION_CONTEXT('',{scope},'manufacturing')")
    project = text.add(f"MACHINING_PROJECT('face','',$,({machining}))")
    version = text.add(f"PRODUCT_DEFINITION_FORMATION('','',{project})")
    defined = text.add(f"PRODUCT_DEFINITION('','',{version},{stage})")
    plan = text.add("MACHINING_WORKPLAN('plan','','','')")
    process = text.add(f"PRODUCT_DEFINITION_PROCESS('machining','',{plan},'')")
    text.add(f"PROCESS_PRODUCT_ASSOCIATION('','',{defined},{process})")
    step = text.add("MACHINING_WORKINGSTEP('FACE','machining','','')")
    text.add(f"MACHINING_PROCESS_SEQUENCE_RELATIONSHIP('','',{plan},{step},1.)")
    cut = text.add(f"{operation}('face','','','')")
    text.add(f"MACHINING_OPERATION_RELATIONSHIP('','',{step},{cut})")
    kind = text.add("ACTION_RESOURCE_TYPE('cutting tool')")
    text.add(f"MACHINING_TOOL('7','',({cut}),{kind})")

    def technology(owner: str, feed: float | None) -> None:
        own = text.add("MACHINING_TECHNOLOGY('','milling','','')")
        speed = text.add(
            f"MEASURE_REPRESENTATION_ITEM('rotational speed',NUMERIC_MEASURE(-600.),{rpm})"
        )
        text.prop(own, "spindle", "MACHINING_SPINDLE_SPEED_REPRESENTATION", speed, context)
        if feed is not None:
            item = text.add(
                f"MEASURE_REPRESENTATION_ITEM('feed speed',NUMERIC_MEASURE({feed}),{mm_min})"
            )
            text.prop(own, "feedrate", "MACHINING_FEED_SPEED_REPRESENTATION", item, context)
        text.add(f"MACHINING_TECHNOLOGY_RELATIONSHIP('','',{owner},{own})")

    technology(cut, None)
    for number, path in enumerate(paths, 1):
        at = text.add(f"MACHINING_TOOLPATH('P{number}','cutter location trajectory','','')")
        text.add(f"MACHINING_TOOLPATH_SEQUENCE_RELATIONSHIP('','',{cut},{at},{number}.)")
        technology(at, path.feed)
        if path.points:
            points = ",".join(_points(text, path.points))
            curve = text.add(f"POLYLINE('',({points}))")
            text.prop(at, "basic curve", "REPRESENTATION", curve, context)
        else:
            item = text.add(
                f"DESCRIPTIVE_REPRESENTATION_ITEM('next-nc circular motion','{path.arc}')"
            )
            text.prop(at, "next-nc circular motion", "REPRESENTATION", item, context)
        if path.feed is None:
            item = text.add("DESCRIPTIVE_REPRESENTATION_ITEM('','rapid')")
            name = "MACHINING_TOOLPATH_SPEED_PROFILE_REPRESENTATION"
            text.prop(at, "speed profile", name, item, context)
    return HEAD + "\n".join(text.lines) + "\nENDSEC;\nEND-ISO-10303-21;\n"


def _units(text: _Text) -> tuple[str, str, str]:
    """Units of length, spindle speed and feed."""
    mm = text.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))")
    second = text.add("(NAMED_UNIT(*)SI_UNIT($,.SECOND.)TIME_UNIT())")
    sixty = text.add(f"TIME_MEASURE_WITH_UNIT(TIME_MEASURE(60.),{second})")
    of_time = text.add("DIMENSIONAL_EXPONENTS(0.,0.,1.,0.,0.,0.,0.)")
    minute = text.add(
        f"(CONVERSION_BASED_UNIT('minute',{sixty})NAMED_UNIT({of_time})TIME_UNIT())"
    )
    none = text.add("DIMENSIONAL_EXPONENTS(0.,0.,0.,0.,0.,0.,0.)")
    turn = text.add(f"CONTEXT_DEPENDENT_UNIT({none},'revolution')")
    per_minute = text.add(f"DERIVED_UNIT_ELEMENT({minute},-1.)")
    rpm = text.add(
        f"DERIVED_UNIT(({text.add(f'DERIVED_UNIT_ELEMENT({turn},1.)')},{per_minute}))"
    )
    mm_min = text.add(
        f"DERIVED_UNIT(({text.add(f'DERIVED_UNIT_ELEMENT({mm},1.)')},{per_minute}))"
    )
    return mm, rpm, mm_min


def _points(text: _Text, points: Sequence[Point]) -> Iterator[str]:
    for x, y, z in points:
        yield text.add(f"CARTESIAN_POINT('',({x},{y},{z}))")
