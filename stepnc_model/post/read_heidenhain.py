"""Reader of Heidenhain Klartext, for the subset that the writer produces.

The reader is strict: unknown lines and arcs whose radii differ are errors.
"""

import re
from collections.abc import Callable, Iterable, Iterator
from math import cos, radians, sin

from stepnc_model.errors import PostError
from stepnc_model.post.blocks import (
    Block,
    Circular,
    Comment,
    Coolant,
    CoolantKind,
    DrillingCycle,
    Linear,
    MachineType,
    OptionalStopBlock,
    Pause,
    ProgramEnd,
    ProgramStopBlock,
    Rapid,
    Rate,
    RateMode,
    Retract,
    RigidTap,
    SpindleDirection,
    SpindleOff,
    SpindleOn,
    SpindleOrient,
    ToolChange,
    expanded,
)
from stepnc_model.post.grid import turn_between
from stepnc_model.post.words import NUMBER, number_of, shown, whole
from stepnc_model.toolpath.path import ArcPlane, CycleKind, Point
from stepnc_model.units import rev_s_from_rpm, speed_from_mm_min

ROUND = 0.016
"""Greatest difference of the radii to both ends of an arc, mm (iTNC 530, MP7431)."""

WORD = re.compile(
    rf"(DR(?=[+-](?:\s|$))|(?:IPA|IZ|FU|[XYZF])(?={NUMBER}))({NUMBER}|[+-])|(FMAX|R0)|\S+"
)
PARAMETER = re.compile(rf"(Q[0-9]+)\s*=\s*({NUMBER})")
TITLE = re.compile(r"[A-Z ]*")
TOOL = re.compile(rf"TOOL CALL(?: ([0-9]+) Z)?(?: S({NUMBER}))?")
DWELL = re.compile(rf"CYCL DEF 9\.1 DWELL ({NUMBER})")
DEFINITION = re.compile(r"CYCL DEF (200|201|205|207)\b(.*)")
SILENT = re.compile(
    r"(?:BEGIN|END) PGM \S+ MM|CYCL DEF 9\.0 DWELL TIME|"
    r"CYCL DEF 13\.0 ORIENTATION|CYCL DEF 13\.1 ANGLE 0"
)
PLANES = {"XY": ArcPlane.XY, "XZ": ArcPlane.ZX, "YZ": ArcPlane.YZ}

READ = frozenset({
    "Q200", "Q201", "Q202", "Q203", "Q206", "Q211", "Q239", "Q256", "Q257", "Q258", "Q259",
})  # fmt: skip
"""Cycle parameters that are evaluated."""

ZERO = frozenset({"Q204", "Q205", "Q208", "Q210", "Q212"})
"""Cycle parameters that are accepted only with the value 0."""


class HeidenhainReader:
    """Reader of one Klartext program; tracks the modal state and the position of the tool."""

    def __init__(self, machine: MachineType) -> None:
        if machine is MachineType.LATHE:
            raise PostError("Klartext is supported for mills only")
        self.at: Point = (0.0, 0.0, 0.0)
        self.speed: float | None = None
        self.rate: Rate | None = None
        self.centre: dict[str, float] = {}
        self._cycle: tuple[str, dict[str, float]] | None = None
        self._functions: dict[str, Callable[[], Block]] = {
            "M3": lambda: self._spindle(SpindleDirection.CLOCKWISE),
            "M4": lambda: self._spindle(SpindleDirection.COUNTERCLOCKWISE),
            "M5": SpindleOff,
            "M8": lambda: Coolant(kinds=frozenset({CoolantKind.FLOOD})),
            "M9": Coolant,
            "M19": SpindleOrient,
            "STOP": ProgramStopBlock,
            "M0": ProgramStopBlock,
            "M1": OptionalStopBlock,
            "M2": ProgramEnd,
            "M30": ProgramEnd,
        }

    def blocks(self, lines: Iterable[str]) -> Iterator[Block]:
        """Read the program as neutral blocks.

        Raises
        ------
        PostError
            With the line number and the problem.
        """
        held, start = "", 0
        for number, line in enumerate(lines, 1):
            start = start or number
            code, mark, text = line.rstrip().partition(";")
            # A tilde continues the block on the next line, after the name of a parameter.
            held += " " + (code if mark else code.removesuffix("~")).strip()
            if line.rstrip().endswith("~"):
                continue
            try:
                yield from self._block(held.strip())
                if mark and "=" not in code:
                    yield Comment(text=text.strip())
            except PostError as error:
                raise PostError(str(error), line=start) from None
            held, start = "", 0
        if held:
            raise PostError("the last block is continued, but no line follows", line=start)

    def _block(self, numbered: str) -> Iterator[Block]:
        number, _, text = numbered.partition(" ")
        if not number.isdigit():
            raise PostError(f"'{shown(numbered)}': a block must begin with its number")
        text = text.strip()
        if not text or SILENT.fullmatch(text):
            return
        kind, _, rest = text.partition(" ")
        if text in self._functions:
            yield self._functions[text]()
        elif kind in {"L", "C", "CP", "CC"}:
            yield from self._moved(kind, rest)
        elif text == "CYCL CALL":
            yield from self._called()
        elif found := TOOL.fullmatch(text):
            yield from self._tool(found[1], found[2])
        elif found := DWELL.fullmatch(text):
            yield Pause(seconds=_unsigned("DWELL ", found[1]))
        elif found := DEFINITION.fullmatch(text):
            self._cycle = (found[1], _parameters(found[2]))
        else:
            raise PostError(f"'{shown(text)}': unknown Klartext block")

    def _tool(self, number: str | None, speed: str | None) -> Iterator[Block]:
        if speed is not None:
            self.speed = _unsigned("S", speed)
        if number is not None:
            yield ToolChange(number=whole(number_of("TOOL CALL ", number), "TOOL CALL "))

    def _spindle(self, sense: SpindleDirection) -> Block:
        return SpindleOn(speed=self._rpm(), sense=sense)

    def _rpm(self) -> float:
        if self.speed is None:
            raise PostError("the spindle has no speed: no TOOL CALL with S came before")
        return rev_s_from_rpm(self.speed)

    def _moved(self, kind: str, text: str) -> Iterator[Block]:
        words: dict[str, str] = {}
        for found in WORD.finditer(text):
            letter = found[1] or found[3]
            if letter is None or letter in words:
                raise PostError(f"word {shown(found[0])}: unknown here, or given twice")
            words[letter] = found[2] or ""
        if kind == "CC":
            if len(words) != 2 or not set(words) <= set("XYZ"):
                raise PostError("CC needs two of X, Y and Z, and nothing else")
            self.centre = {letter: number_of(letter, text) for letter, text in words.items()}
            return
        is_rapid = words.pop("FMAX", None) is not None
        words.pop("R0", None)
        self._set_rate(words)
        if kind == "L":
            yield self._line(words, is_rapid=is_rapid)
        else:
            yield self._arc(words) if kind == "C" else self._helix(words)
        if words:
            raise PostError(f"word {next(iter(words))}: not used by this block")

    def _set_rate(self, words: dict[str, str]) -> None:
        if "F" in words:
            self.rate = Rate(value=speed_from_mm_min(number_of("F", words.pop("F"))))
        elif "FU" in words:
            value = number_of("FU", words.pop("FU"))
            self.rate = Rate(value=value, mode=RateMode.PER_REVOLUTION)

    def _feed(self) -> Rate:
        if self.rate is None or self.rate.value <= 0.0:
            raise PostError("a feed move without F")
        return self.rate

    def _end(self, words: dict[str, str]) -> Point:
        x, y, z = (
            number_of(letter, words.pop(letter)) if letter in words else value
            for letter, value in zip("XYZ", self.at, strict=True)
        )
        return x, y, z

    def _line(self, words: dict[str, str], *, is_rapid: bool) -> Block:
        is_retract = set(words) == {"Z"}
        self.at = self._end(words)
        if not is_rapid:
            return Linear(end=self.at, rate=self._feed())
        return Retract(z=self.at[2]) if is_retract else Rapid(end=self.at)

    def _middle(self) -> tuple[ArcPlane, Point]:
        """Plane and centre of the last CC."""
        plane = PLANES.get("".join(sorted(self.centre)))
        if plane is None:
            raise PostError("an arc without a preceding CC in two axes")
        x, y, z = (
            self.centre.get(letter, value) for letter, value in zip("XYZ", self.at, strict=True)
        )
        return plane, (x, y, z)

    def _arc(self, words: dict[str, str]) -> Block:
        plane, centre = self._middle()
        sense = _sense(words)
        start, end = self.at, self._end(words)
        turn = turn_between(start, end, centre, plane, sense=sense, slack=ROUND)
        normal = plane.axes[2]
        if start[normal] != end[normal]:
            raise PostError("C leaves the plane of its CC")
        self.at = end
        return Circular(end=end, centre=centre, turn=turn, plane=plane, rate=self._feed())

    def _helix(self, words: dict[str, str]) -> Block:
        plane, centre = self._middle()
        if "IPA" not in words or plane is not ArcPlane.XY:
            raise PostError("CP is only supported with IPA, about a CC in x and y")
        turn, sense = radians(number_of("IPA", words.pop("IPA"))), _sense(words)
        rise = number_of("IZ", words.pop("IZ", "0"))
        if turn * sense <= 0.0:
            raise PostError("the signs of IPA and DR differ")
        u, v = self.at[0] - centre[0], self.at[1] - centre[1]
        end = (
            centre[0] + u * cos(turn) - v * sin(turn),
            centre[1] + u * sin(turn) + v * cos(turn),
            self.at[2] + rise,
        )
        self.at = end
        return Circular(end=end, centre=centre, turn=turn, plane=plane, rate=self._feed())

    def _called(self) -> Iterator[Block]:
        """Execute the last defined cycle at the position of the tool."""
        if self._cycle is None:
            raise PostError("CYCL CALL without a defined cycle")
        number, values = self._cycle
        wanted = {"Q200", "Q201", "Q203", "Q239" if number == "207" else "Q206"}
        if not wanted <= set(values):
            missing = " ".join(sorted(wanted - set(values)))
            raise PostError(f"cycle {number}: {missing} is missing")
        if values["Q201"] >= 0.0:
            raise PostError(f"cycle {number}: Q201={values['Q201']:g} must be negative")
        surface, bottom = values["Q203"], values["Q203"] + values["Q201"]
        at = (self.at[0], self.at[1], surface + values["Q200"])
        if at[2] != self.at[2]:
            self.at = at
            yield Rapid(end=at)
        if number == "207":
            yield RigidTap(
                start=self.at,
                bottom_z=bottom,
                lead=abs(values["Q239"]),
                speed=self._rpm(),
                sense=SpindleDirection.CLOCKWISE
                if values["Q239"] > 0.0
                else SpindleDirection.COUNTERCLOCKWISE,
            )
            return
        if values["Q206"] <= 0.0:
            raise PostError(f"cycle {number}: Q206={values['Q206']:g} is not a valid feed")
        kind, step, above = _kind(number, values)
        yield expanded(
            DrillingCycle(
                kind=kind,
                at=at[:2],
                retract_z=at[2],
                bottom_z=bottom,
                rate=Rate(value=speed_from_mm_min(values["Q206"])),
                step_depth=step,
                retract_distance=above,
                dwell=values.get("Q211", 0.0),
            )
        )


def _parameters(text: str) -> dict[str, float]:
    """Parameters of a cycle definition, after its title."""
    found: dict[str, float] = {}
    for name, value in PARAMETER.findall(text):
        number = number_of(f"{name}=", value)
        is_zero = name in ZERO and not number
        if name in found or not (name in READ or is_zero):
            raise PostError(f"word {name}={value}: not supported, or given twice")
        if number < 0.0 and name not in {"Q201", "Q203", "Q239"}:
            raise PostError(f"word {name}={value}: must not be negative")
        found[name] = number
    rest = PARAMETER.sub("", text)
    if not TITLE.fullmatch(rest):
        raise PostError(f"'{shown(rest)}': unknown text in a cycle definition")
    return found


def _unsigned(word: str, text: str) -> float:
    """Value of a word that must not be negative."""
    value = number_of(word, text)
    if value < 0.0:
        raise PostError(f"word {word}{text}: must not be negative")
    return value


def _kind(number: str, values: dict[str, float]) -> tuple[CycleKind, float, float]:
    """Kind of a drilling cycle, its peck depth and its retract distance, mm."""
    if number == "201":
        return CycleKind.BORE, 0.0, 0.0
    if number == "205" and values.get("Q257"):
        return CycleKind.CHIP_BREAK, values["Q257"], values.get("Q256", 0.0)
    step, depth = values.get("Q202", 0.0), -values["Q201"]
    if step and step < depth:
        return CycleKind.PECK, step, values.get("Q258", 0.0)
    return (CycleKind.DWELL if values.get("Q211") else CycleKind.DRILL), 0.0, 0.0


def _sense(words: dict[str, str]) -> float:
    text = words.pop("DR", "")
    if text not in {"+", "-"}:
        raise PostError("an arc without DR+ or DR-")
    return 1.0 if text == "+" else -1.0
