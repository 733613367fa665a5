"""Tolerant control for Heidenhain Klartext.

After Heidenhain, "iTNC 530 User's Manual, Conversational Programming". Blocks that are not
understood are reported; from there the position is unknown until the program states it anew.
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from math import copysign, isnan, nan

from stepnc_model.nc.flow import BEHIND_THE_END, ProgramFlow, places
from stepnc_model.nc.klartext_cycles import CYCLES, hole_of
from stepnc_model.nc.klartext_datum import KlartextDatum
from stepnc_model.nc.klartext_parameters import KlartextParameters
from stepnc_model.nc.klartext_switches import KlartextSwitches
from stepnc_model.nc.klartext_wear import with_wear
from stepnc_model.nc.klartext_words import KlartextWords, flags_of, klartext_words
from stepnc_model.nc.moves import CompensationSide, FeedMode, MoveFlag, MoveKind
from stepnc_model.nc.recorder import MoveRecorder
from stepnc_model.nc.remarks import Remarks
from stepnc_model.nc.text import NcText
from stepnc_model.nc.thread import NcThread, tap_by_feed
from stepnc_model.toolpath.arc import centre_of_radius, on_circle, turn_of
from stepnc_model.toolpath.path import ArcPlane, Point
from stepnc_model.units import SECONDS_PER_MINUTE, mm_from_inches, rad_from_deg, rev_s_from_rpm

LABELS = re.compile(
    rb"^[ \t]*(?:[0-9]+[ \t]+)?LBL[ \t]*([1-9][0-9]*|\"[^\"\r\n]*\")", re.M | re.I
)

PROGRAMS = re.compile(rb"^[ \t]*(?:[0-9]+[ \t]+)?BEGIN[ \t]+(PGM)\b", re.M | re.I)

QUIET_CYCLES = {"9", "13", "32", "14", "20"}
"""Dwell, orientation, tolerance and contour data: none moves an axis."""

MACHINE_AXES = {910, 920}
"""M91 and M92: coordinates of the machine."""
PLUNGE_FACTOR, HANDWHEEL, RETRACT = 1030, 1180, 1400
"""M103, M118 and M140."""


QUIET = frozenset({
    *{"BLK", "TOOL_DEF", "BEGIN", "END", "STOP", "FUNCTION", "SEL", "PATTERN", "HEAD"},
    *{"ERROR", "FN"},
})
PLANES = {"XY": ArcPlane.XY, "XZ": ArcPlane.ZX, "YZ": ArcPlane.YZ}
PATHS = {"L", "C", "CR", "CC", "CP", "LP", "CTP", "CT", "CHF", "RND", "LN"}
END_FUNCTIONS = {20, 300}


class HeidenhainControl:
    """Control that executes one Klartext program. Running state."""

    def __init__(self, text: NcText) -> None:
        self.text = text
        self.recorder = MoveRecorder()
        self.recorder.frames = {"preset": 0}
        self.remarks = Remarks(text)
        self.flow = ProgramFlow(text, self.recorder)
        self.switches = KlartextSwitches(self.recorder, self.remarks)
        self.scale = 1.0
        self.centre: dict[str, float] = {}
        self.feed_mode = FeedMode.PER_MINUTE
        """Reference of the word F."""
        self.spindle = 0.0
        self.sense = 0.0
        self.datum = KlartextDatum(self.recorder)
        self.parameters = KlartextParameters()
        self.cycle: tuple[str, dict[str, float], int] | None = None
        self.rotary: dict[str, float] = {}
        self.is_called_always = False
        self._labels = dict(reversed(list(places(text, LABELS))))
        self._paths: dict[str, Callable[[KlartextWords], None]] = {
            "L": self._line,
            "C": self._circle,
            "CR": self._radius,
            "CC": self._pole,
            "CP": self._helix,
        }

    def run(self) -> None:
        """Execute the program from its first block to its end.

        Raises
        ------
        PostError
            If the program repeats or nests blocks without end, with the line.
        """
        block, size = 0, len(self.text)
        while block < size:
            self.flow.step(block)
            block = self._execute(block)
        for _, other in list(places(self.text, PROGRAMS))[1:2]:
            self.remarks.warn(other, BEHIND_THE_END)

    def _execute(self, block: int) -> int:
        words = klartext_words(self.text.block(block))
        recorder = self.recorder
        recorder.block = block
        is_sure = not (words.is_skippable or recorder.standing & MoveFlag.CONDITIONAL)
        self.parameters.take(words, is_sure=is_sure)
        recorder.flags = flags_of(words).value
        self.switches.begun(words)
        head = words.names[0] if words.names else ""
        if not words.is_empty:
            following = self._steered(words, block)
            if following is not None:
                self.flow.steered(following)
                return following
        if head in PATHS:
            self._path(head, words)
        elif head == "PRESET":
            self.datum.to_preset(words.numbers[-1] if words.numbers else nan)
        elif head == "TCH":
            # A probing cycle may set the datum.
            self.lose("a probing cycle is not executed")
            self.datum.shift_to([nan, nan, nan])
        elif head in {"TOOL", "CYCL", "PLANE", "APPR", "DEP", "TRANS"}:
            self._other(head, words)
        elif head and head not in QUIET and not words.functions:
            self.lose(f"{head} is not known")
        elif words.strange and not words.assigned:
            self.lose(f"'{words.strange[0]}' is not known")
        self._functions(words)
        self.switches.ended(words)
        return len(self.text) if END_FUNCTIONS & set(words.functions) else block + 1

    def lose(self, why: str) -> None:
        """Report a block that is not understood; the position is unknown after it."""
        self.remarks.lost(self.recorder.block, why)
        self.recorder.unknown()

    # Flow.

    def _steered(self, words: KlartextWords, block: int) -> int | None:
        """Next block if this one steers the program, else None."""
        head, numbers = words.names, words.numbers
        if head[:1] == ["LBL"]:
            if words.label == "0":
                following = self.flow.leave() if self.flow.is_called else None
                return block + 1 if following is None else following
            return block + 1
        if head[:2] == ["CALL", "LBL"]:
            return self._called(words, block)
        if head[:1] == ["CALL"] or (head[:1] == ["SEL"] and "PGM" in head):
            self.remarks.lost(block, "another program is called")
            self.parameters.forget()
            self.recorder.unknown()
            self._forget_feed()
            return block + 1
        if head[:1] == ["FN"] and numbers and numbers[0] in {9.0, 10.0, 11.0, 12.0}:
            return self._condition(block)
        if head[:1] == ["IF"] or "GOTO" in head:
            return self._condition(block)
        if head[:2] == ["BEGIN", "PGM"]:
            self.scale = mm_from_inches(1.0) if "INCH" in head else 1.0
            setting = self.recorder.setting
            self.recorder.setting = replace(setting, unit=self.scale, is_centre_absolute=True)
            return block + 1
        if head[:2] == ["END", "PGM"]:
            return len(self.text)
        return None

    def _condition(self, block: int) -> int:
        is_sure = not self.recorder.standing & MoveFlag.CONDITIONAL
        if is_sure and not self.flow.is_worn_out:
            following = self.parameters.jumped(self.text.block(block), block, self._labels)
            if following is not None:
                return following
        self.remarks.lost(block, "conditions and jumps are not evaluated")
        self.recorder.unknown()
        self.recorder.standing |= MoveFlag.CONDITIONAL.value
        return block + 1

    def _called(self, words: KlartextWords, block: int) -> int:
        target = self._labels.get(words.label)
        if target is None:
            self.remarks.lost(block, f"the label {words.label} is not in this file")
            self.recorder.unknown()
            self._forget_feed()
            return block + 1
        times = words.values.get("REP")
        if times is None and "REP" not in words.names:
            return self.flow.call(block, target + 1)
        return self.flow.repeat(block, target + 1, times=max(0, int(times or 0)))

    # Feed, spindle, tool.

    def _forget_feed(self) -> None:
        self.recorder.word, self.recorder.fed_by = nan, self.recorder.block
        self.recorder.is_fresh = True
        self.recorder.standing |= MoveFlag.MACRO_FEED.value

    def _take_mode(self, words: KlartextWords) -> None:
        """Take M136 and M137: F counts by the revolution, or by the minute again."""
        for code, mode in ((1360, FeedMode.PER_REVOLUTION), (1370, FeedMode.PER_MINUTE)):
            if code in words.functions and self.feed_mode is not mode:
                self.feed_mode = mode
                self.recorder.setting = replace(self.recorder.setting, mode=mode)
                self.recorder.word, self.recorder.fed_by = nan, -1

    def _feed(self, words: KlartextWords) -> bool:
        """Take F or FU of a path block; return whether the block is a rapid."""
        recorder = self.recorder
        if PLUNGE_FACTOR in words.functions:
            # F is a share of the feed in force here.
            words.values.pop("F", None)
        if "F" in words.macros or "FU" in words.macros or {"AUTO", "FAUTO"} & set(words.names):
            self._forget_feed()
        self._take_mode(words)
        for name, mode in (("F", self.feed_mode), ("FU", FeedMode.PER_REVOLUTION)):
            value = words.values.get(name)
            if value is not None:
                per_minute = mode is FeedMode.PER_MINUTE
                recorder.setting = replace(recorder.setting, mode=mode)
                recorder.word = value * self.scale / (SECONDS_PER_MINUTE if per_minute else 1.0)
                recorder.fed_by, recorder.is_fresh = recorder.block, True
                recorder.standing &= ~MoveFlag.MACRO_FEED.value
        if "FZ" in words.values or "FT" in words.values:
            self._forget_feed()
        return "FMAX" in words.names or "MAX" in words.names

    def _functions(self, words: KlartextWords) -> None:
        for code, sense in ((30, 1.0), (40, -1.0), (50, 0.0), (130, 1.0), (140, -1.0)):
            if code in words.functions:
                self.sense = sense
                self._turn()
                self.switches.spindle(starts=sense != 0.0)
        if MACHINE_AXES & set(words.functions):
            self.recorder.at = [nan, nan, nan]
        if RETRACT in words.functions:
            self.recorder.move(MoveKind.RAPID, (*self.recorder.at[:2], nan))
        self._take_mode(words)

    def _turn(self) -> None:
        speed = self.sense * rev_s_from_rpm(self.spindle) + 0.0
        known = None if isnan(speed) else speed
        self.recorder.setting = replace(self.recorder.setting, spindle=known)

    def _other(self, head: str, words: KlartextWords) -> None:
        """Execute what is no path: tools, cycles, planes, approaches."""
        names = words.names
        if names[:2] == ["TOOL", "CALL"]:
            self._tool(words)
        elif names[:2] == ["TOOL", "DEF"]:
            return
        elif names[:2] == ["CYCL", "DEF"]:
            self._define(words)
        elif names[:2] == ["CYCL", "CALL"]:
            if "PAT" in names or "POS" in names:
                self.lose("a cycle call with positions of its own is not expanded")
            else:
                self._drill()
        elif head == "PLANE" or (head == "TRANS" and "DATUM" not in names):
            self.datum.transform("RESET" not in names)
        elif head == "TRANS":
            self.datum.shift_by(words, scale=self.scale, is_anew="RESET" in names)
        else:
            if head == "DEP":
                self._end_compensation()
            elif {"RL", "RR"} & set(words.names):
                self.recorder.standing |= MoveFlag.COMPENSATED.value
            self.lose(f"{head} is not expanded")
            self._feed(words)

    def _tool(self, words: KlartextWords) -> None:
        if "S" in words.values or "S" in words.macros:
            self.spindle = words.values.get("S", nan)
            self._turn()
            if self.sense and not words.numbers:
                self.switches.spindle(starts=False)
        self._feed(words)
        self.recorder.setting = with_wear(self.recorder.setting, words, scale=self.scale)
        if words.numbers:
            tool = int(words.numbers[0])
            self.recorder.setting = replace(self.recorder.setting, tool=tool, tool_name="")
            self.recorder.lose(2)
            self.switches.tool()
        elif words.texts:
            self.recorder.setting = replace(
                self.recorder.setting, tool=None, tool_name=words.texts[0].strip('"')
            )
            self.remarks.note(self.recorder.block, "the tool has a name and no number")
            self.recorder.lose(2)

    def _define(self, words: KlartextWords) -> None:
        """Take the definition of a cycle."""
        number = words.cycle.partition(".")[0]
        if number in {"7", "8", "10", "11", "26", "19"}:
            self.datum.change(words, number, scale=self.scale)
        elif number == "247":
            self.datum.to_preset(words.assigned.get("Q339", nan))
        elif number in CYCLES:
            self.cycle = number, dict(words.assigned), self.recorder.block
        elif words.cycle == "9.1":
            self.recorder.dwell(max(0.0, words.numbers[-1] if words.numbers else 0.0))
        elif number not in QUIET_CYCLES:
            self.cycle = None
            if number not in {"21", "22", "23", "24", "25", "27", "28", "29"}:
                self.cycle = number, {}, self.recorder.block

    # Paths.

    def _path(self, head: str, words: KlartextWords) -> None:
        if "RL" in words.names or "RR" in words.names:
            self.recorder.standing |= MoveFlag.COMPENSATED.value
            self._beside(CompensationSide(is_left="RL" in words.names))
        elif "R0" in words.names:
            self._end_compensation()
        if words.strange or HANDWHEEL in words.functions:
            what = f"'{words.strange[0]}'" if words.strange else "the handwheel offset M118"
            self._feed(words)
            self.lose(f"{what} is not understood")
            return
        path = self._paths.get(head)
        if head in {"RND", "CHF"}:
            self._rounded(words)
        elif path is not None:
            path(words)
        else:
            is_rapid = self._feed(words)
            self.lose(f"the path {head} is not understood" if not is_rapid else head)

    def _beside(self, side: CompensationSide | None) -> None:
        """Take the side of the contour on which the tool goes."""
        self.recorder.setting = replace(self.recorder.setting, side=side)

    def _end_compensation(self) -> None:
        """End the radius compensation: this block still leads away from the contour."""
        self.recorder.flags |= self.recorder.standing & MoveFlag.COMPENSATED.value
        self.recorder.standing &= ~MoveFlag.COMPENSATED.value
        self._beside(None)

    def _rounded(self, words: KlartextWords) -> None:
        """A chamfer or rounding between two lines: its neighbours stay in one piece."""
        self.recorder.round_corner()
        if "F" in words.values:
            self.remarks.note(self.recorder.block, "the feed of a rounding is left alone")

    def _coordinate(self, words: KlartextWords, axis: int) -> float:
        letter = "XYZ"[axis]
        at = self.recorder.at[axis]
        is_given = letter in words.values or f"I{letter}" in words.values
        if letter in words.macros or f"I{letter}" in words.macros:
            return nan
        if is_given and MACHINE_AXES & set(words.functions):
            self.recorder.flags |= MoveFlag.MACHINE.value
            return nan
        if f"I{letter}" in words.values:
            return at + self.scale * words.values[f"I{letter}"]
        value = words.values.get(letter)
        return at if value is None else self.scale * value

    def _end(self, words: KlartextWords) -> list[float]:
        if any(name in words.values for name in ("IPA", "PA", "PR", "IPR")):
            return [nan, nan, nan]
        return [self._coordinate(words, axis) for axis in range(3)]

    def _line(self, words: KlartextWords) -> None:
        is_rapid = self._feed(words)
        self._rotary(words)
        if not any(letter in words.values or letter in words.macros for letter in _AXES):
            return
        kind = MoveKind.RAPID if is_rapid else MoveKind.LINE
        self.recorder.move(kind, self._end(words))
        self._called_after(words)

    def _rotary(self, words: KlartextWords) -> None:
        for letter in "ABCUVW":
            if letter in words.macros or f"I{letter}" in words.macros:
                self.rotary[letter] = nan
            elif letter in words.values or f"I{letter}" in words.values:
                before = self.rotary.get(letter, 0.0)
                added = words.values.get(f"I{letter}", 0.0)
                self.rotary[letter] = words.values.get(letter, before + added)
                self.recorder.flags |= MoveFlag.ROTARY.value
        if any(value != 0.0 for value in self.rotary.values()):
            self.recorder.standing |= MoveFlag.ROTARY.value
        else:
            self.recorder.standing &= ~MoveFlag.ROTARY.value

    def _called_after(self, words: KlartextWords) -> None:
        """Execute the cycle after a move with M99, or after each with M89."""
        if 890 in words.functions:
            self.is_called_always = True
        if 990 in words.functions or self.is_called_always:
            self._drill()
        if 990 in words.functions:
            self.is_called_always = False

    def _pole(self, words: KlartextWords) -> None:
        self.centre = {}
        for axis, letter in enumerate("XYZ"):
            is_given = any(
                name in values
                for name in (letter, f"I{letter}")
                for values in (words.values, words.macros)
            )
            if is_given:
                self.centre[letter] = self._coordinate(words, axis)
        if not self.centre and not words.values and not isnan(sum(self.recorder.at[:2])):
            self.centre = {"X": self.recorder.at[0], "Y": self.recorder.at[1]}

    def _middle(self) -> tuple[ArcPlane | None, Point]:
        plane = PLANES.get("".join(sorted(self.centre)))
        x, y, z = (
            self.centre.get(letter, value)
            for letter, value in zip("XYZ", self.recorder.at, strict=True)
        )
        return plane, (x, y, z)

    def _circle(self, words: KlartextWords) -> None:
        self._feed(words)
        plane, centre = self._middle()
        self._arc(words, plane, centre)

    def _radius(self, words: KlartextWords) -> None:
        self._feed(words)
        axes = "".join(sorted(letter for letter in "XYZ" if letter in words.axes))
        plane = PLANES.get(axes, ArcPlane.XY)
        sense = words.sense
        radius = words.values.get("R", nan) * self.scale
        centre = centre_of_radius(
            self.recorder.at, self._end(words), radius=radius, plane=plane, sense=sense
        )
        self._arc(words, plane, centre)

    def _arc(self, words: KlartextWords, plane: ArcPlane | None, centre: Point) -> None:
        end = self._end(words)
        if plane is None or not words.sense:
            self.lose("an arc without its centre or its direction")
            self.recorder.at = end
            return
        turn = turn_of(self.recorder.at, end, centre, plane, sense=words.sense)
        start = self.recorder.at
        known = [start[axis] + end[axis] for axis in plane.axes[:2]]
        if isnan(turn) and not isnan(sum(known)):
            self.lose("the arc does not fit its ends")
            self.recorder.at = end
            return
        self.recorder.arc(end, centre, turn=turn, plane=plane)

    def _helix(self, words: KlartextWords) -> None:
        """Arc about the pole by an angle, with a rise."""
        self._feed(words)
        plane, centre = self._middle()
        angle = words.values.get("IPA")
        if plane is not ArcPlane.XY or angle is None or not words.sense:
            self.lose("a polar arc without IPA about a pole in X and Y")
            return
        at = self.recorder.at
        turn = copysign(rad_from_deg(abs(angle)), words.sense)
        level = (at[0], at[1], self._coordinate(words, 2))
        end = on_circle(at, level, centre, plane, turn)
        self.recorder.flags |= MoveFlag.POLAR.value
        if isnan(end[0] + end[1]):
            end = (nan, nan, end[2])
        self.recorder.arc(end, centre, turn=turn, plane=plane)

    def _drill(self) -> None:
        """Execute the last defined cycle at the position of the tool."""
        if self.cycle is None or self.cycle[0] not in CYCLES:
            self.lose("this cycle is not expanded")
            return
        number, values, block = self.cycle
        recorder, scale = self.recorder, self.scale
        x, y, _ = recorder.at
        hole = hole_of(number, values, (x, y), scale=scale)
        kept = recorder.word, recorder.fed_by
        recorder.word = scale * values.get("Q206", nan) / SECONDS_PER_MINUTE
        recorder.fed_by, recorder.is_fresh = block, True
        recorder.flags |= MoveFlag.CYCLE.value | MoveFlag.FIXED.value
        recorder.move(MoveKind.RAPID, (x, y, hole.retract_z))
        recorder.hole(hole, self._tap(values))
        if values.get("Q204"):
            back = values.get("Q203", 0.0) + values["Q204"]
            recorder.move(MoveKind.RAPID, (x, y, scale * back))
        recorder.word, recorder.fed_by = kept
        recorder.is_fresh = True

    def _tap(self, values: Mapping[str, float]) -> NcThread:
        """Thread of a tapping cycle: its pitch Q239, or feed and spindle."""
        speed = rev_s_from_rpm(self.spindle)
        if "Q239" in values:
            # A negative pitch cuts a left-hand thread.
            pitch = self.scale * values["Q239"]
            return NcThread(lead=abs(pitch), speed=copysign(speed, pitch))
        speed = copysign(speed, self.sense or 1.0)
        return tap_by_feed(self.recorder.word, FeedMode.PER_MINUTE, speed=speed)


_AXES = (*"XYZ", "IX", "IY", "IZ", "PA", "PR", "IPA", "IPR", *"ABCUVW")
