"""Tolerant control for Sinumerik 840D: the words, cycles and flow in which it differs.

After Siemens, "SINUMERIK 840D sl Fundamentals" and "Job Planning".
"""

import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from math import copysign, inf, isnan, nan

from stepnc_model.nc import iso_codes
from stepnc_model.nc.block_words import BlockWords, take_word
from stepnc_model.nc.definitions import take_definition
from stepnc_model.nc.drilling import drilling
from stepnc_model.nc.flow import places
from stepnc_model.nc.iso_control import IsoControl
from stepnc_model.nc.iso_flow import IsoFlow, Steered
from stepnc_model.nc.iso_modes import INCH, CodeTable, IsoModes
from stepnc_model.nc.iso_motions import ModalMotion, Shot
from stepnc_model.nc.moves import FeedMode, MoveFlag, MoveKind
from stepnc_model.nc.parameters import SINUMERIK, Parameters, plain_name
from stepnc_model.nc.text import NcText
from stepnc_model.nc.thread import NcThread
from stepnc_model.nc.token import NUMBER
from stepnc_model.post.blocks import MachineType
from stepnc_model.post.dialect import Dialect
from stepnc_model.post.words import LARGEST
from stepnc_model.toolpath.path import ArcPlane, CycleKind, Point
from stepnc_model.units import SECONDS_PER_MINUTE, rev_s_from_rpm

LABELS = re.compile(rb"^[ \t]*/?[ \t]*(?:N[0-9]+[ \t]*)?([A-Z_]{2}[A-Z0-9_]*):", re.M | re.I)
REPEAT = re.compile(r"REPEAT\s+([A-Z_]{2}\w*)(?:\s+P\s*=?\s*([0-9]+))?", re.I)
NUMBERS = re.compile(rb"^[ \t]*/?[ \t]*(N[0-9]+)", re.M | re.I)
JUMP = re.compile(r"(?:IF\s*(.+?)\s*)?\bGOTO([FBC]?)\s+([A-Z_][A-Z0-9_]*)\s*", re.I | re.S)
JUMP_TARGETS = re.compile(rb"GOTO[FBC]?[ \t]+(N[0-9]+)", re.I)
END_LABEL = "ENDLABEL"
R, R_NAMES = re.compile(r"R[0-9]+"), re.compile(r"\bR[0-9]+\b")
NESTED = re.compile(r"(IC|AC)\((.+)\)", re.I)
"""Component of an end with an expression."""

COMPONENT = re.compile(rf"(IC|AC)\(\s*({NUMBER})\s*\)", re.I)

CYCLES = {
    "CYCLE81": CycleKind.DRILL,
    "CYCLE82": CycleKind.DWELL,
    "CYCLE83": CycleKind.PECK,
    "CYCLE84": CycleKind.TAP,
    "CYCLE840": CycleKind.TAP,
    "CYCLE85": CycleKind.BORE,
    "CYCLE86": CycleKind.BORE_STOP,
    "CYCLE87": CycleKind.BORE_STOP,
    "CYCLE88": CycleKind.BORE_STOP,
    "CYCLE89": CycleKind.BORE,
}
PITCHES = {"CYCLE84": 8, "CYCLE840": 10}
"""Index of the argument PIT of the tapping cycles."""

TAPPING_SPEED = 10
"""Index of the argument SST of CYCLE84."""

FIRST_DEPTH, DEPTH_OF_PECK, BREAKS = 5, 6, 11
"""Indices of the arguments FDEP, FDPR and VARI of CYCLE83."""

RETRACT, ABOVE_PECK = 14, 16
"""Indices of the arguments _VRT and _DIS1 of CYCLE83."""

PAUSES = {"CYCLE82": 5, "CYCLE83": 8, "CYCLE85": 5, "CYCLE86": 5, "CYCLE88": 5, "CYCLE89": 5}
"""Index of the argument DTB, the dwell at the bottom."""

READ: dict[str, frozenset[int]] = {name: frozenset({5}) for name in CYCLES} | {
    "CYCLE81": frozenset(),
    "CYCLE83": frozenset({6, 8, 11, 14, 16}),
    "CYCLE84": frozenset({6, 8, 9, 10, 11}),
    "CYCLE840": frozenset({6, 7, 8, 10}),
    "CYCLE85": frozenset({5, 6, 7}),
    "CYCLE86": frozenset({5, 6, 10}),
    "CYCLE89": frozenset({5, 6, 7}),
}
"""Indices of the arguments behind DPR that are read, or change no move."""

NEUTRAL = {("CYCLE83", 10): 1.0}
"""Values of arguments that change nothing, where it is not 0: the share FRF of the feed."""

FRAME_VARIABLE = re.compile(r"\$[A-Z]_[A-Z]*(?:FR|FRAME)\b", re.I)
"""Variable that holds a frame, such as ``$P_UIFR[1]``."""

ROUNDING = ("CHF", "CHR", "RND", "RNDM")
STRANGE_ENDS = ("ANG", "AP", "RP", "I1", "J1", "K1")
"""Addresses that give the end of a move in a form that is not understood."""


class SinumerikFlow(IsoFlow):
    """Steering of one Sinumerik program: repeats by label. Running state."""

    def __init__(self, control: Steered, parameters: Callable[[], Parameters]) -> None:
        super().__init__(control)
        self._parameters = parameters
        self._targets: list[tuple[str, int]] = []
        """Labels and block numbers that jumps may lead to, in the order of the program."""
        if b"GOTO" in control.text.data.upper():
            self._targets = [*places(control.text, LABELS), *places(control.text, NUMBERS)]
            self._targets.sort(key=lambda target: target[1])
            jumps = JUMP_TARGETS.findall(control.text.data)
            self.targets = {int(name[1:]) for name in jumps if name[1:].isdigit()}
        self._labels = dict(reversed(list(places(control.text, LABELS))))

    def statement(self, text: str, block: int) -> int:
        """Repeat from a label to this block; other statements depend on conditions."""
        if take_definition(text, self._parameters(), is_sure=self._is_sure):
            return block + 1
        jump = JUMP.fullmatch(text)
        if jump is not None and self._is_sure:
            following = self._jumped(jump, block)
            if following is not None:
                return following
        found = REPEAT.fullmatch(text)
        target = self._labels.get(found[1].upper()) if found is not None else None
        if found is None or target is None or target > block:
            # A loop may change what it counts with.
            self._parameters().forget()
            return super().statement(text, block)
        return self._flow.repeat(block, target, times=int(found[2] or 1))

    def _jumped(self, jump: re.Match[str], block: int) -> int | None:
        """Next block by a jump or its condition; None: not evaluated."""
        value = 1.0 if jump[1] is None else self._parameters().evaluate(jump[1])
        if isnan(value) or self._flow.is_worn_out:
            return None
        if value == 0.0:
            return block + 1
        target, way = jump[3].upper(), jump[2].upper()
        places = [place for name, place in self._targets if name == target]
        ahead = [place for place in places if place > block]
        behind = [place for place in reversed(places) if place <= block]
        found = {"F": ahead, "B": behind}.get(way, ahead + behind)
        return found[0] if found else None

    def ended(self, words: BlockWords, block: int) -> int:
        """Block after this one; M17 and RET return to the program that called."""
        if 170 in words.functions or "RET" in words.names:
            following = self._flow.leave()
            return len(self._text) if following is None else following
        return super().ended(words, block)


class SinumerikModes(IsoModes):
    """Modal state of one Sinumerik control. Running state."""

    def own_codes(self) -> CodeTable:
        """Actions of the G codes in which Sinumerik differs."""
        thread = partial(self._take_motion, ModalMotion.THREAD)
        table: CodeTable = {
            **dict.fromkeys(iso_codes.SINUMERIK_INCHES, partial(self._take_unit, INCH)),
            **dict.fromkeys(iso_codes.SINUMERIK_METRIC, partial(self._take_unit, 1.0)),
            **dict.fromkeys((630, 3310, 3320), thread),
            1530: partial(self._take, "shot", Shot.MACHINE),
            9610: partial(self.to_mode, FeedMode.PER_MINUTE),
        }
        for code in (580, 590):
            table[code] = self._shift_by_words
        for code, place in ((740, "the reference point"), (750, "a fixed point")):
            table[code] = partial(self._leave_for, f"G{code // 10} moves to {place}")
        return table

    def _shift_by_words(self, words: BlockWords) -> None:
        """Take a shift by G58 or G59: what follows stands in a frame of its own."""
        for letter in "XYZ":
            words.values.pop(letter, None)
            words.macros.pop(letter, None)
        self.set_frame(self.recorder.block)

    def _leave_for(self, why: str, _: BlockWords) -> None:
        self.lose(why)


class SinumerikControl(IsoControl):
    """Control that executes one Sinumerik program. Running state."""

    def __init__(self, text: NcText, dialect: Dialect, machine: MachineType) -> None:
        super().__init__(text, dialect, machine)
        self.parameters = Parameters(SINUMERIK)
        self._modal_call: tuple[str, list[float]] | None = None

    def forget(self) -> None:
        """Forget position, modal state and R parameters, which another program may change."""
        super().forget()
        self.parameters.forget()

    def evaluate(self, words: BlockWords) -> None:
        """Compute words from R parameters as far as they are known, then set parameters."""
        given: dict[str, str] = {}
        for name in [name for name in words.macros if self._is_parameter(name)]:
            given[plain_name(name)] = words.macros.pop(name)
        for name in [name for name in words.values if self._is_parameter(name)]:
            given[plain_name(name)] = f"{words.values.pop(name):.9f}"
        is_sure = not (words.is_skippable or words.strange)
        is_sure = is_sure and not self.recorder.standing & MoveFlag.CONDITIONAL
        values = {name: self.parameters.evaluate(text) for name, text in given.items()}
        # What a word is that names a parameter of its own block depends on the order.
        named = {name: self._named_in(text) for name, text in given.items()}
        for name in given:
            self.parameters.set(name, nan)
        for name, text in list(words.macros.items()):
            self._compute(words, name, text)
        for name, value in values.items():
            is_own = not (named[name] & given.keys()) - {name}
            self.parameters.set(name, value if is_sure and is_own else nan)

    def _is_parameter(self, name: str) -> bool:
        return R.fullmatch(name) is not None or name in self.parameters.declared

    def _named_in(self, text: str) -> set[str]:
        """Parameters that an expression names."""
        found = set(map(plain_name, R_NAMES.findall(text.upper())))
        words = set(re.findall(r"[A-Z_][A-Z0-9_]*", text.upper()))
        return found | set(map(plain_name, words & self.parameters.declared))

    def _compute(self, words: BlockWords, name: str, text: str) -> None:
        """Compute one word, or the number within its IC() or AC(), if it is known."""
        found = NESTED.fullmatch(text)
        value = self.parameters.evaluate(text if found is None else found[2])
        if isnan(value) or abs(value) > LARGEST:
            return
        if found is not None:
            words.macros[name] = f"{found[1]}({value:.9f})"
            return
        del words.macros[name]
        words.evaluated.add(name)
        take_word(words, name, value)

    def settle(self, words: BlockWords) -> None:
        """Take names and assignments, then the words of ISO 6983."""
        for name in words.names:
            self._name(name, words)
        for name, arguments in words.calls:
            self._call(name, arguments)
        self._assignments(words)
        super().settle(words)
        if self.is_lathe and "T" in words.values:
            words.functions.append(60)
        if "D" in words.values:
            self.modes.lose_height()
        if 960 in words.codes or 970 in words.codes:
            self.modes.to_mode(FeedMode.PER_REVOLUTION)
        self._dwell_words(words)

    def has_plain_moves(self) -> bool:
        """True if axis words alone say where a move ends; not while a cycle follows each."""
        return self._modal_call is None and super().has_plain_moves()

    def rounding(self, words: BlockWords) -> Sequence[str]:
        """Addresses of chamfers and roundings at the end of a line."""
        modal = words.values.get("RNDM")
        if modal is not None:
            self.modes.stand(MoveFlag.ROUNDED, modal != 0.0)
        return ROUNDING

    def start_modes(self, machine: MachineType) -> IsoModes:
        """Modal state at the start of the program."""
        return SinumerikModes(self.recorder, self.dialect, machine)

    def steer(self) -> IsoFlow:
        """Steering of the program."""
        return SinumerikFlow(self, lambda: self.parameters)

    def _dwell_words(self, words: BlockWords) -> None:
        """Drop the words of a dwell, which are no coordinates."""
        if 40 in words.codes:
            words.values.pop("S", None)

    def _name(self, name: str, words: BlockWords) -> None:
        """Take a keyword, or the call of a program that is not here."""
        if name in {"TRANS", "ATRANS"}:
            self._trans(words, is_added=name == "ATRANS")
        elif name in {"DIAMON", "DIAM90"}:
            self.modes.is_diameter = True
        elif name == "DIAMOF":
            self.modes.is_diameter = False
        elif name in iso_codes.SINUMERIK_TRANSFORMS:
            has_arguments = bool(words.values or words.macros or words.calls)
            self.modes.transform(has_arguments or name.startswith("TRA"))
            for letter in ("X", "Y", "Z", "RPL"):
                words.values.pop(letter, None)
                words.macros.pop(letter, None)
        elif name == "TRAFOOF":
            self.modes.transform(False)
        elif name == "SUPA":
            self.modes.shot = Shot.MACHINE
        elif name == "MCALL":
            self._modal_call = None
        elif name in {"RET"} or name in iso_codes.SINUMERIK_QUIET:
            return
        elif not name.startswith("%_N_") and name != END_LABEL:
            self.modes.lose(f"the program or keyword {name} is not known")
            self.forget()

    def _trans(self, words: BlockWords, *, is_added: bool) -> None:
        """Shift the coordinates by TRANS or ATRANS."""
        old = self.modes.shift if is_added else [0.0, 0.0, 0.0]
        if not is_added:
            self.modes.transform(False)
        new = []
        for axis, letter in enumerate("XYZ"):
            is_macro = words.macros.pop(letter, None) is not None
            value = self.modes.scale * words.values.pop(letter, 0.0)
            new.append(nan if is_macro else old[axis] + value)
        self.modes.shift_to(new)

    def _assignments(self, words: BlockWords) -> None:
        """Take addresses with an equals sign that are no coordinates."""
        limit = words.values.pop("LIMS", None)
        if limit is not None:
            self.modes.limit = rev_s_from_rpm(limit)
        if "S1" in words.values:
            words.values["S"] = words.values.pop("S1")
        if "M1" in words.values:
            words.functions.append(round(10.0 * min(words.values.pop("M1"), 1e6)))
        name = words.macros.pop("T", None)
        if name is not None:
            self.modes.tool, self.modes.tool_name = None, name.strip('"')
            self.remarks.note(self.recorder.block, "the tool has a name and no number")
            if self.is_lathe:
                self.modes.to_tool(None)
        if any(map(FRAME_VARIABLE.match, (*words.values, *words.macros))):
            self.modes.set_frame(self.recorder.block)
        if "L" in words.values or "L" in words.macros:
            number = words.values.get("L", nan)
            self.modes.lose(f"the subprogram L{number:g} is not in this file")
            self.forget()
        for name in STRANGE_ENDS:
            if name in words.values or name in words.macros:
                self.modes.lose(f"ends given by {name} are not understood")

    def _call(self, name: str, arguments: str) -> None:
        """Take a cycle or another name with arguments."""
        is_modal = name.startswith("MCALL")
        cycle = name.removeprefix("MCALL")
        numbers = [self._argument(each) for each in arguments.split(",")]
        if is_modal:
            self._modal_call = cycle, numbers
        elif cycle in CYCLES:
            self._drill_here(cycle, numbers)
        elif cycle in iso_codes.SINUMERIK_TRANSFORMS:
            self.modes.transform(bool(arguments.strip()))
        elif cycle == "MSG":
            self.switches.message(arguments.strip().strip('"'))
        elif cycle not in iso_codes.SINUMERIK_QUIET:
            self.modes.lose(f"the cycle or program {cycle} is not expanded")
            self.forget()

    def _move(self, words: BlockWords) -> None:
        super()._move(words)
        if self._modal_call is not None and self.has_axes(words) and not self.modes.lost:
            self._drill_here(*self._modal_call)

    def _argument(self, text: str) -> float:
        """Argument of a cycle: infinite if it is left out, NaN if it is not known."""
        value = self.parameters.evaluate(text) if text.strip() else inf
        return value if abs(value) <= LARGEST or value == inf else nan

    def _drill_here(self, name: str, arguments: Sequence[float]) -> None:
        """Execute a drilling cycle at the position of the tool."""
        numbers = [*arguments, *[inf] * (ABOVE_PECK + 1 - len(arguments))]
        back, surface, safe, bottom, depth = numbers[:5]
        if name not in CYCLES or isnan(sum(v for v in numbers[:5] if v != inf)):
            self.modes.lose(f"the cycle {name} is not expanded")
            return
        self._note_unread(name, arguments)
        surface, safe = _given(surface, 0.0), abs(_given(safe, 0.0))
        bottom = surface - abs(_given(depth, 0.0)) if bottom == inf else bottom
        kind, step, above = CYCLES[name], 0.0, nan
        if name == "CYCLE83":
            first = _given(numbers[FIRST_DEPTH], surface)
            step = _given(numbers[DEPTH_OF_PECK], surface - first)
            is_peck = _given(numbers[BREAKS], 0.0) == 1.0
            kind = CycleKind.PECK if is_peck else CycleKind.CHIP_BREAK
            above = _given(numbers[ABOVE_PECK if is_peck else RETRACT], nan)
        self.recorder.flags |= MoveFlag.CYCLE.value
        x, y, _ = self.recorder.at
        top = self.modes.scale * (surface + safe)
        back = self.modes.scale * _given(back, surface + safe)
        self.recorder.move(MoveKind.RAPID, (x, y, back))
        self.recorder.move(MoveKind.RAPID, (x, y, top))
        hole = drilling(
            kind,
            (x, y),
            heights=(top, self.modes.scale * bottom),
            step=self.modes.scale * step,
            above=above,
            dwell=_given(numbers[PAUSES[name]], 0.0) if name in PAUSES else 0.0,
        )
        self.recorder.hole(hole, self._tap(name, numbers))
        self.recorder.move(MoveKind.RAPID, (x, y, back))

    def _note_unread(self, name: str, arguments: Sequence[float]) -> None:
        """Note arguments of a cycle that would change it and are not read."""
        for index, value in enumerate(arguments):
            is_neutral = value in {inf, 0.0, NEUTRAL.get((name, index))}
            if index >= 5 and not is_neutral and index not in READ[name]:
                self.switches.unread(f"{name}: argument {index + 1}, {value:g}, is not read")
        if name in {"CYCLE85", "CYCLE89"}:
            feeds = {_given(each, 0.0) for each in [*arguments, inf, inf][6:8]} - {0.0}
            if feeds - {self.recorder.word * SECONDS_PER_MINUTE / self.modes.scale}:
                self.switches.unread(f"{name}: feeds other than the one in force are not read")
        if len(arguments) < 4 or all(each == inf for each in arguments[3:5]):
            self.switches.unread(f"{name}: needs RTP, RFP, SDIS and DP")

    def _tap(self, name: str, numbers: Sequence[float]) -> NcThread:
        """Thread of a tapping cycle; of others one that is not known."""
        speed = self.modes.tapping_speed
        if name not in PITCHES:
            return NcThread(lead=nan)
        if name == "CYCLE84" and numbers[TAPPING_SPEED] != inf:
            speed = copysign(rev_s_from_rpm(numbers[TAPPING_SPEED]), speed or 1.0)
        lead = self.modes.scale * abs(_given(numbers[PITCHES[name]], nan))
        return NcThread(lead=lead, speed=speed)

    def thread(self, words: BlockWords, end: list[float]) -> NcThread:
        """Thread by I, J or K of the axis that moves most; of G63 by feed and spindle."""
        if 630 in words.codes:
            return self.modes.fed_tap
        moves = [abs(e - s) for s, e in zip(self.recorder.at, end, strict=True)]
        lead = nan if isnan(sum(moves)) else words.values.get("IJK"[moves.index(max(moves))])
        found = NcThread(lead=nan if lead is None else self.modes.scale * abs(lead))
        speed = self.modes.tapping_speed
        if speed is not None and (3310 in words.codes or 3320 in words.codes):
            # A negative lead cuts a left-hand thread.
            found = replace(found, speed=copysign(speed, lead or 1.0))
        return found.back if 3320 in words.codes else found

    def coordinate(self, words: BlockWords, axis: int, letter: str) -> float:
        """Coordinate of one axis, which IC() or AC() may make relative or absolute."""
        found = COMPONENT.fullmatch(words.macros.get(letter, ""))
        if found is None:
            return super().coordinate(words, axis, letter)
        half = 0.5 if axis == 0 and self.modes.is_diameter else 1.0
        value = self.modes.scale * half * float(found[2])
        return value if found[1].upper() == "AC" else self.recorder.at[axis] + value

    def radius(self, words: BlockWords) -> float | None:
        """Radius that CR= gives for an arc, mm, or None."""
        if "CR" in words.macros:
            return nan
        value = words.values.get("CR")
        return None if value is None else value * self.modes.scale

    def centre(self, words: BlockWords, plane: ArcPlane) -> Point:
        """Centre of an arc by I, J and K, or by the angle AR=, mm."""
        middle = list(super().centre(words, plane))
        for axis in plane.axes[:2]:
            found = COMPONENT.fullmatch(words.macros.get("IJK"[axis], ""))
            if found is not None:
                value = self.modes.scale * float(found[2])
                half = 0.5 if axis == 0 and self.modes.is_diameter else 1.0
                is_relative = found[1].upper() == "IC"
                middle[axis] = self.recorder.at[axis] + value if is_relative else half * value
        if "AR" in words.values or "AR" in words.macros:
            return (nan, nan, nan)
        return middle[0], middle[1], middle[2]

    def seconds(self, words: BlockWords) -> float:
        """Time of a dwell, s: its F word."""
        return self.modes.pause

    def turns(self, words: BlockWords) -> int:
        """Full turns of an arc by TURN=."""
        return max(0, min(int(words.values.get("TURN", 0.0)), 1000))


def _given(value: float, default: float) -> float:
    """Argument of a cycle, or its default if it is left out."""
    return default if value == inf else value
