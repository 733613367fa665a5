"""Text of AP238 programs of tool paths alone, instance by instance, as CAM systems write them.

The instances are those of the AIM of ISO 10303-238; a :class:`Manner` says how a writer names
and leaves out what the standard leaves open.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cache, cached_property

Point = tuple[float, float, float]

HEAD = (
    "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(('{about}'),'2;1');\n"
    "FILE_NAME('part','2026-01-01T00:00:00',(''),(''),'','{writer}','');\n"
    "FILE_SCHEMA(('{schema}'));\nENDSEC;\nDATA;\n"
)
TAIL = "ENDSEC;\nEND-ISO-10303-21;\n"


@dataclass(frozen=True, kw_only=True)
class Manner:
    """How a writer writes what the standard leaves open."""

    writer: str = "post"
    about: str = ""
    schema: str = "INTEGRATED_CNC_SCHEMA"
    length: str = "mm"
    """Unit of lengths: ``mm`` or ``inch``."""
    describes: bool = False
    """Whether properties and relationships repeat the kind of what they belong to."""
    first: int = 1
    """Number of the first instance."""
    step: int = 1
    """Distance between the numbers of instances."""
    ending: str = "\n"


@dataclass
class AimText:
    """Instances of a file, in the order in which they are added."""

    manner: Manner = field(default_factory=Manner)
    lines: list[str] = field(default_factory=list)
    ordinal: int = 0

    def add(self, text: str) -> str:
        """Add an instance; return its reference."""
        number = self.manner.first + self.manner.step * len(self.lines)
        self.lines.append(f"#{number}={text};")
        return f"#{number}"

    def text(self) -> str:
        """Text of the whole file."""
        head = HEAD.format(
            writer=self.manner.writer, about=self.manner.about, schema=self.manner.schema
        )
        whole = head + "\n".join(self.lines) + "\n" + TAIL
        return whole.replace("\n", self.manner.ending)

    # Units

    @cached_property
    def mm(self) -> str:
        return self.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))")

    @cached_property
    def degree(self) -> str:
        radian = self.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))")
        none = self.add("DIMENSIONAL_EXPONENTS(0.,0.,0.,0.,0.,0.,0.)")
        size = self.add(
            f"PLANE_ANGLE_MEASURE_WITH_UNIT(PLANE_ANGLE_MEASURE(0.0174532925199433),{radian})"
        )
        return self.add(
            f"(CONVERSION_BASED_UNIT('degree',{size})NAMED_UNIT({none})PLANE_ANGLE_UNIT())"
        )

    @cached_property
    def minute(self) -> str:
        second = self.add("(NAMED_UNIT(*)SI_UNIT($,.SECOND.)TIME_UNIT())")
        sixty = self.add(f"TIME_MEASURE_WITH_UNIT(TIME_MEASURE(60.),{second})")
        time = self.add("DIMENSIONAL_EXPONENTS(0.,0.,1.,0.,0.,0.,0.)")
        return self.add(
            f"(CONVERSION_BASED_UNIT('minute',{sixty})NAMED_UNIT({time})TIME_UNIT())"
        )

    @cached_property
    def turn(self) -> str:
        none = self.add("DIMENSIONAL_EXPONENTS(0.,0.,0.,0.,0.,0.,0.)")
        return self.add(f"CONTEXT_DEPENDENT_UNIT({none},'revolution')")

    @cached_property
    def _lengths(self) -> dict[str, str]:
        return {"mm": self.mm}

    def length_unit(self, name: str) -> str:
        """Unit of length: mm, m, inch or foot."""
        known = self._lengths
        if name == "m":
            known[name] = known.get(name) or self.add(
                "(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.))"
            )
        elif name not in known:
            size = {"inch": 25.4, "foot": 304.8}[name]
            of = self.add(f"LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE({size}),{self.mm})")
            power = self.add("DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.)")
            known[name] = self.add(
                f"(CONVERSION_BASED_UNIT('{name}',{of})LENGTH_UNIT()NAMED_UNIT({power}))"
            )
        return known[name]

    @cached_property
    def _derived(self) -> dict[tuple[str, str], str]:
        return {}

    def derived(self, over: str, under: str) -> str:
        """Quotient of two units."""
        key = over, under
        if key not in self._derived:
            parts = [
                self.add(f"DERIVED_UNIT_ELEMENT({unit},{power})")
                for unit, power in ((over, "1."), (under, "-1."))
            ]
            self._derived[key] = self.add(f"DERIVED_UNIT(({','.join(parts)}))")
        return self._derived[key]

    @cached_property
    def rpm(self) -> str:
        return self.derived(self.turn, self.minute)

    @cached_property
    def context(self) -> str:
        unit = self.length_unit(self.manner.length)
        return self.add(
            f"(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT(({unit},"
            f"{self.degree}))REPRESENTATION_CONTEXT('','3D'))"
        )

    # Pieces that occur again and again

    def prop(self, owner: str, name: str, shown: str, *, kind: str = "") -> None:
        """Add a property of an action, with its representation."""
        about = kind if self.manner.describes else ""
        given = self.add(f"ACTION_PROPERTY('{name}','{about}',{owner})")
        self.add(f"ACTION_PROPERTY_REPRESENTATION('','{about}',{given},{shown})")

    def word(self, owner: str, name: str, value: str, *, kind: str = "") -> None:
        """Add a property in words."""
        item = self.add(f"DESCRIPTIVE_REPRESENTATION_ITEM('{name}','{value}')")
        shown = self.add(f"REPRESENTATION('',({item}),{self.context})")
        self.prop(owner, name, shown, kind=kind)

    def measure(self, name: str, value: float, unit: str = "") -> str:
        """Add a length with its unit."""
        of = self.length_unit(unit or self.manner.length)
        return self.add(
            "(LENGTH_MEASURE_WITH_UNIT()MEASURE_REPRESENTATION_ITEM()"
            f"MEASURE_WITH_UNIT(LENGTH_MEASURE({real(value)}),{of})"
            f"REPRESENTATION_ITEM('{name}'))"
        )

    def point(self, at: Sequence[float]) -> str:
        """Add a point."""
        return self.add(f"CARTESIAN_POINT('',({','.join(map(real, at))}))")

    def direction(self, along: Sequence[float]) -> str:
        """Add a direction."""
        return self.add(f"DIRECTION('',({','.join(map(real, along))}))")

    def place(
        self,
        name: str = "orientation",
        at: Point = (0, 0, 0),
        axis: Point = (0, 0, 1),
        x: Point = (1, 0, 0),
    ) -> str:
        """Add a placement."""
        return self.add(
            f"AXIS2_PLACEMENT_3D('{name}',{self.point(at)},{self.direction(axis)},"
            f"{self.direction(x)})"
        )

    # Curves

    def polyline(self, points: Iterable[Point]) -> str:
        """Add a polyline."""
        return self.add(f"POLYLINE('',({','.join(map(self.point, points))}))")

    def arc(self, centre: Point, start: Point, end: Point, *, is_left: bool = True) -> str:
        """Add an arc in a plane across z, counter-clockwise or clockwise."""
        at = self.place("", centre)
        dx, dy = start[0] - centre[0], start[1] - centre[1]
        circle = self.add(f"CIRCLE('',{at},{real((dx * dx + dy * dy) ** 0.5)})")
        sense = ".T." if is_left else ".F."
        return self.add(
            f"TRIMMED_CURVE('',{circle},({self.point(start)}),({self.point(end)}),"
            f"{sense},.CARTESIAN.)"
        )

    def chain(self, curves: Sequence[str]) -> str:
        """Add a composite curve."""
        parts = [
            self.add(f"COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,{each})") for each in curves
        ]
        return self.add(f"COMPOSITE_CURVE('',({','.join(parts)}),.U.)")

    def spline(self, poles: Sequence[Point], degree: int = 3) -> str:
        """Add a clamped B-spline with even knots."""
        inner = len(poles) - degree - 1
        times = [degree + 1, *[1] * inner, degree + 1]
        knots = ",".join(real(float(each)) for each in range(inner + 2))
        return self.add(
            f"B_SPLINE_CURVE_WITH_KNOTS('',{degree},({','.join(map(self.point, poles))}),"
            f".UNSPECIFIED.,.F.,.F.,({','.join(map(str, times))}),({knots}),.UNSPECIFIED.)"
        )

    # Project

    @cached_property
    def _stages(self) -> tuple[str, str]:
        scope = self.add("APPLICATION_CONTEXT('')")
        return (
            self.add(f"PRODUCT_CONTEXT('CNC Machining',{scope},'manufacturing')"),
            self.add(f"PRODUCT_DEFINITION_CONTEXT('CNC Machining',{scope},'manufacturing')"),
        )

    def product(self, name: str, kind: str = "PRODUCT") -> str:
        """Add a product and its definition."""
        of, stage = self._stages
        product = self.add(f"{kind}('{name}','',$,({of}))")
        version = self.add(f"PRODUCT_DEFINITION_FORMATION('','',{product})")
        return self.add(f"PRODUCT_DEFINITION('','',{version},{stage})")

    def project(self, plan: str) -> str:
        """Add the project with its main workplan."""
        project = self.product("part", "MACHINING_PROJECT")
        process = self.add(f"PRODUCT_DEFINITION_PROCESS('machining','',{plan},'')")
        self.add(f"PROCESS_PRODUCT_ASSOCIATION('','',{project},{process})")
        return project

    def workpiece(self, project: str) -> str:
        """Add a workpiece without geometry."""
        piece = self.product("workpiece")
        self.add(f"MACHINING_PROJECT_WORKPIECE_RELATIONSHIP('','','',{project},{piece})")
        return piece

    def raw_part(self, piece: str, shape: str, items: Sequence[str]) -> None:
        """Add the raw part of a workpiece: its representation's type and items."""
        raw = self.product("raw part")
        count = self.add(f"MEASURE_WITH_UNIT(COUNT_MEASURE(1.),{self._count})")
        self.add(f"MAKE_FROM_USAGE_OPTION('','','',{piece},{raw},0,'',{count})")
        of = self.add(f"PRODUCT_DEFINITION_SHAPE('','',{raw})")
        shown = self.add(f"{shape}('raw part',({','.join(items)}),{self.context})")
        self.add(f"SHAPE_DEFINITION_REPRESENTATION({of},{shown})")

    @cached_property
    def _count(self) -> str:
        none = self.add("DIMENSIONAL_EXPONENTS(0.,0.,0.,0.,0.,0.,0.)")
        return self.add(f"CONTEXT_DEPENDENT_UNIT({none},'count')")

    def block(self, piece: str, low: Point, size: Point, unit: str = "") -> None:
        """Add a block as raw part."""
        names = ("length", "width", "height")
        items = [self.measure(name, each, unit) for name, each in zip(names, size, strict=True)]
        self.raw_part(piece, "BLOCK_SHAPE_REPRESENTATION", [*items, self.place(at=low)])

    def bar(self, piece: str, diameter: float, low: float, length: float) -> None:
        """Add a bar along z as raw part."""
        items = [
            self.measure("diameter", diameter),
            self.measure("length", length),
            self.place(at=(0, 0, low)),
        ]
        self.raw_part(piece, "CYLINDRICAL_SHAPE_REPRESENTATION", items)

    def setup(self, plan: str, at: str, piece: str, within: str) -> None:
        """Add a setup of a workplan with its origin, and the workpiece placed within it."""
        setup = self.product("setup", "MACHINING_SETUP")
        of = self.add(f"PRODUCT_DEFINITION_SHAPE('orientation','',{setup})")
        shown = self.add(f"REPRESENTATION('',({at}),{self.context})")
        self.add(f"SHAPE_DEFINITION_REPRESENTATION({of},{shown})")
        process = self.add(f"PRODUCT_DEFINITION_PROCESS('setup','',{plan},'')")
        self.add(f"PROCESS_PRODUCT_ASSOCIATION('','',{setup},{process})")
        held = self.add(f"MACHINING_SETUP_WORKPIECE_RELATIONSHIP('','','',{setup},{piece})")
        of = self.add(f"PRODUCT_DEFINITION_SHAPE('','',{held})")
        moved = self.add(f"ITEM_DEFINED_TRANSFORMATION('','',$,{within})")
        relation = self.add(
            "(REPRESENTATION_RELATIONSHIP('','',$,$)"
            f"REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION({moved})"
            "SHAPE_REPRESENTATION_RELATIONSHIP())"
        )
        self.add(f"CONTEXT_DEPENDENT_SHAPE_REPRESENTATION({relation},{of})")

    # Executables, operations, tools

    def plan(self, name: str) -> str:
        """Add a workplan."""
        return self.add(f"MACHINING_WORKPLAN('{name}','','','')")

    def next(self, plan: str, executable: str) -> None:
        """Put an executable at the end of a workplan."""
        self.ordinal += 1
        self.add(
            f"MACHINING_PROCESS_SEQUENCE_RELATIONSHIP('','',{plan},{executable},"
            f"{self.ordinal}.)"
        )

    def step(
        self,
        plan: str,
        name: str,
        operation: str,
        *,
        kind: str = "machining",
        feature: str = "",
    ) -> str:
        """Add a workingstep at the end of a workplan; return its operation."""
        step = self.add(f"MACHINING_WORKINGSTEP('{name}','{kind}','','')")
        self.next(plan, step)
        cut = self.add(f"{operation}('{name}','','','')")
        self.add(f"MACHINING_OPERATION_RELATIONSHIP('','{kind}',{step},{cut})")
        if feature:
            process = self.add(f"MACHINING_FEATURE_PROCESS('','{kind}','','')")
            self.add(f"MACHINING_FEATURE_RELATIONSHIP('','{kind}',{step},{process})")
            cutting = self.add(f"PROPERTY_PROCESS('machining','{kind}',{process},'')")
            self.add(f"PROCESS_PROPERTY_ASSOCIATION('','{kind}',{cutting},{feature})")
        return cut

    def feature(self, *, at: str = "", of: str = "$") -> str:
        """Add a feature that is nothing but a tool path."""
        feature = self.add(f"INSTANCED_FEATURE('','toolpath','','toolpath',{of},.F.)")
        if at:
            shape = self.add(f"PRODUCT_DEFINITION_SHAPE('orientation','toolpath',{feature})")
            shown = self.add(f"SHAPE_REPRESENTATION_WITH_PARAMETERS('',({at}),{self.context})")
            self.add(f"SHAPE_DEFINITION_REPRESENTATION({shape},{shown})")
        return feature

    def tool(
        self,
        name: str,
        about: str,
        cuts: Sequence[str],
        sizes: dict[str, float] | None = None,
        *,
        teeth: int = 0,
        kind: str = "milling cutting tool",
    ) -> str:
        """Add a tool with the sizes of its body."""
        of = self.add(f"ACTION_RESOURCE_TYPE('{kind}')")
        tool = self.add(f"MACHINING_TOOL('{name}','{about}',({','.join(cuts)}),{of})")
        items = [self.measure(key, size) for key, size in (sizes or {}).items()]
        if teeth:
            items.append(
                self.add(
                    "(MEASURE_REPRESENTATION_ITEM()MEASURE_WITH_UNIT(COUNT_MEASURE("
                    f"{teeth}.),{self._count})"
                    "REPRESENTATION_ITEM('number of effective teeth'))"
                )
            )
        for item, key in zip(
            items, [*(sizes or {}), "number of effective teeth"], strict=False
        ):
            body = self.add(f"RESOURCE_PROPERTY('tool body','{about}',{tool})")
            shown = self.add(f"MACHINING_TOOL_BODY_REPRESENTATION('',({item}),{self.context})")
            self.add(f"RESOURCE_PROPERTY_REPRESENTATION('{key}','{about}',{body},{shown})")
        return tool

    def insert(self, tool: str, corner: float, depth: float) -> None:
        """Add the cutting edge of a turning tool."""
        of = self.add("ACTION_RESOURCE_TYPE('turning cutting edge')")
        edge = self.add(f"MACHINING_CUTTING_COMPONENT('','',(),{of},'',$)")
        self.add(f"ACTION_RESOURCE_RELATIONSHIP('',$,{tool},{edge})")
        item = self.measure("maximum side cutting depth", depth)
        shown = self.add(f"REPRESENTATION('',({item}),{self.context})")
        most = self.add(f"RESOURCE_PROPERTY('maximum side cutting depth','',{edge})")
        self.add(f"RESOURCE_PROPERTY_REPRESENTATION('','',{most},{shown})")
        item = self.measure("radius", corner)
        shown = self.add(
            f"MACHINING_CUTTING_CORNER_REPRESENTATION('rounded corner',({item}),{self.context})"
        )
        corners = self.add(f"RESOURCE_PROPERTY('corner transitions','',{edge})")
        self.add(f"RESOURCE_PROPERTY_REPRESENTATION('','',{corners},{shown})")

    # Technologies and tool paths

    def technology(
        self,
        *,
        spindle: float | None = None,
        feed: float | None = None,
        per_turn: float | None = None,
        surface: tuple[float, float] | None = None,
        unit: str = "",
        kind: str = "milling",
    ) -> str:
        """Add a technology: speed in rpm, feed in a length per minute or per turn.

        ``surface`` is the cutting speed, in m/min or feet per minute, and the greatest speed.
        """
        own = self.add(f"MACHINING_TECHNOLOGY('','{kind}','','')")
        of = self.length_unit(unit or self.manner.length)
        if spindle is not None:
            item = self._number("rotational speed", spindle, self.rpm)
            self._speed(own, "spindle", "SPINDLE_SPEED", "spindle speed", [item], kind)
        if surface is not None:
            across = self.length_unit("foot" if unit == "inch" else "m")
            items = [
                self._number("surface speed", surface[0], self.derived(across, self.minute)),
                self._number("maximum rotational speed", surface[1], self.rpm),
            ]
            self._speed(own, "spindle", "SPINDLE_SPEED", "cutting speed", items, kind)
        if feed is not None:
            item = self._number("feed speed", feed, self.derived(of, self.minute))
            self._speed(own, "feedrate", "FEED_SPEED", "feed speed", [item], kind)
        if per_turn is not None:
            item = self._number("feed per revolution", per_turn, self.derived(of, self.turn))
            self._speed(own, "feedrate", "FEED_SPEED", "feed per revolution", [item], kind)
        return own

    def _number(self, name: str, value: float, unit: str) -> str:
        return self.add(
            f"MEASURE_REPRESENTATION_ITEM('{name}',NUMERIC_MEASURE({real(value)}),{unit})"
        )

    def _speed(
        self, owner: str, name: str, what: str, called: str, items: Sequence[str], kind: str
    ) -> None:
        shown = self.add(
            f"MACHINING_{what}_REPRESENTATION('{called}',({','.join(items)}),{self.context})"
        )
        about = kind if self.manner.describes else ""
        given = self.add(f"ACTION_PROPERTY('{name}','{about}',{owner})")
        self.add(f"ACTION_PROPERTY_REPRESENTATION('{called}','{about}',{given},{shown})")

    def uses(self, owner: str, technology: str) -> None:
        """Let an operation or a tool path have a technology."""
        self.add(f"MACHINING_TECHNOLOGY_RELATIONSHIP('','',{owner},{technology})")

    def functions(self, owner: str, **words: str) -> str:
        """Add machine functions, such as coolant, of an operation."""
        own = self.add("MACHINING_FUNCTIONS('','milling','','')")
        for name, value in words.items():
            self.word(own, name.replace("_", " "), value, kind="milling")
        self.add(f"MACHINING_FUNCTIONS_RELATIONSHIP('','',{owner},{own})")
        return own

    def path(
        self,
        operation: str,
        curve: str = "",
        *,
        technology: str = "",
        is_rapid: bool = False,
        kind: str = "cutter location trajectory",
    ) -> str:
        """Add a tool path at the end of those of an operation."""
        self.ordinal += 1
        path = self.add(f"MACHINING_TOOLPATH('TP {self.ordinal}','{kind}','','')")
        self.add(
            f"MACHINING_TOOLPATH_SEQUENCE_RELATIONSHIP('','',{operation},{path},"
            f"{self.ordinal}.)"
        )
        if technology:
            self.uses(path, technology)
        if curve:
            shown = self.add(f"REPRESENTATION('',({curve}),{self.context})")
            self.prop(path, "basic curve", shown, kind=kind)
        if is_rapid:
            item = self.add("DESCRIPTIVE_REPRESENTATION_ITEM('','rapid')")
            shown = self.add(
                f"MACHINING_TOOLPATH_SPEED_PROFILE_REPRESENTATION('',({item}),{self.context})"
            )
            self.prop(path, "speed profile", shown, kind="rapid")
        return path


@cache
def real(value: float) -> str:
    """A number as Part 21 writes it."""
    text = repr(float(value)).upper()
    mantissa, _, power = text.partition("E")
    mantissa = mantissa.removesuffix("0") if mantissa.endswith(".0") else mantissa
    return f"{mantissa}E{power}" if power else mantissa
