"""Tolerant control for NC code in the manner of ISO 6983: LinuxCNC, Fanuc and Haas.

It executes a program block by block and records its moves. What it does not understand it
reports, and from there it treats coordinates as unknown until the program states them anew.
"""

import re
from collections.abc import Sequence
from math import isnan, nan

from stepnc_model.nc import iso_codes
from stepnc_model.nc.block_words import PLAIN, BlockWords, take_word, words_of
from stepnc_model.nc.drilling import drilling
from stepnc_model.nc.expression import Variables, evaluate, target_of
from stepnc_model.nc.flow import ProgramFlow
from stepnc_model.nc.iso_flow import IsoFlow
from stepnc_model.nc.iso_modes import IsoModes
from stepnc_model.nc.iso_motions import ModalMotion, Shot
from stepnc_model.nc.moves import FeedMode, MoveFlag, MoveKind
from stepnc_model.nc.recorder import MoveRecorder
from stepnc_model.nc.remarks import NO_UNIT, Remarks
from stepnc_model.nc.switches import IsoSwitches
from stepnc_model.nc.text import NcText
from stepnc_model.nc.thread import NcThread, lead_of_path, lead_of_word
from stepnc_model.post.blocks import MachineType
from stepnc_model.post.dialect import Dialect
from stepnc_model.post.words import LARGEST
from stepnc_model.toolpath.arc import FULL, centre_of_radius, turn_of
from stepnc_model.toolpath.path import ArcPlane, CycleKind, Point
from stepnc_model.units import seconds_from_ms

MOST_HOLES = 10_000
"""Greatest number of repeats of a drilling cycle by its word L."""

FRAME_PARAMETERS = re.compile(r"#[ \t]*(?:5[2-3][0-9]{2}|7[0-9]{3}|14[0-9]{3})[ \t]*=(?!=)")
"""Variables that hold offsets of frames: #5201 to #5390, #7001 to #7948, #14001 to #15996."""

PLAIN_MOTIONS = {ModalMotion.RAPID, ModalMotion.LINE}


class IsoControl:
    """Control that executes one program. Running state."""

    def __init__(self, text: NcText, dialect: Dialect, machine: MachineType) -> None:
        self.text, self.dialect = text, dialect
        self.is_lathe = machine is MachineType.LATHE
        self.recorder = MoveRecorder(has_y=not self.is_lathe)
        self.remarks = Remarks(text)
        self.flow = ProgramFlow(text, self.recorder)
        self.variables = Variables(is_linuxcnc=dialect is Dialect.LINUXCNC)
        self.modes = self.start_modes(machine)
        self.switches = IsoSwitches(self.modes, self.remarks)
        self.steering = self.steer()

    @property
    def scale(self) -> float:
        """Length of one unit of the program, mm."""
        return self.modes.scale

    def start_modes(self, machine: MachineType) -> IsoModes:
        """Modal state at the start of the program."""
        return IsoModes(self.recorder, self.dialect, machine)

    def forget(self) -> None:
        """Forget position and modal state."""
        self.modes.forget()

    def modal(self) -> tuple[object, ...]:
        """Position and modal state, to be compared with a later one."""
        return self.modes.modal()

    def forget_changed(self, changed: set[int]) -> None:
        """Forget the parts of the modal state with these indices."""
        self.modes.forget_changed(changed)

    def run(self) -> None:
        """Execute the program from its first block to its end.

        Raises
        ------
        PostError
            If the program repeats or nests blocks without end, with the line.
        """
        block, last, size = 0, 0, len(self.text)
        while block < size:
            self.flow.step(block)
            last, block = block, self._execute(block)
        self.steering.remark_rest(last + 1)
        if self.recorder.count and not self.modes.has_unit:
            codes = "G70 or G71" if self.dialect is Dialect.SINUMERIK else "G20 or G21"
            self.remarks.assume(f"{NO_UNIT} ({codes}): mm are assumed")

    def steer(self) -> IsoFlow:
        """Steering of the program."""
        return IsoFlow(self)

    # One block.

    def _execute(self, block: int) -> int:
        """Execute a block; return the one to execute next."""
        text = self.text.block(block)
        self.recorder.block, self.recorder.flags = block, 0
        if self.has_plain_moves() and self._plain_move(text):
            return block + 1
        words = words_of(text, self.dialect)
        for comment in words.comments:
            self.switches.comment(comment)
        self.modes.shot, self.modes.lost = None, ""
        sets_frame = words.assignments and FRAME_PARAMETERS.search(text)
        self.evaluate(words)
        following = self.steering.follow(words, block)
        if following is not None:
            self.flow.steered(following)
            return following
        if sets_frame:
            self.modes.set_frame(block)
        if words.is_empty:
            return block + 1
        is_last = self._follow_contour(words)
        self._flag(words)
        self.settle(words)
        self.switches.settled(words)
        if words.strange:
            self.modes.lose(f"'{words.strange[0]}' is no word")
        self._move(words)
        self.switches.moved(words)
        if self.modes.lost:
            self.remarks.lost(block, self.modes.lost)
            self.recorder.unknown()
        self.steering.watch()
        if is_last:
            self.modes.stand(MoveFlag.CONDITIONAL, is_on=False)
            self.recorder.unknown()
        return self.steering.ended(words, block)

    def evaluate(self, words: BlockWords) -> None:
        """Compute words from variables as far as they are known, then set variables."""
        if not (words.macros or words.assignments):
            return
        for name, text in list(words.macros.items()):
            value = evaluate(text, self.variables)
            if not isnan(value) and abs(value) <= LARGEST:
                del words.macros[name]
                words.evaluated.add(name)
                take_word(words, name, value)
        self.assign(words)

    def assign(self, words: BlockWords) -> None:
        """Set the variables of a block; unsure values are not known."""
        is_sure = not (words.is_skippable or words.strange)
        is_sure = is_sure and not self.recorder.standing & MoveFlag.CONDITIONAL
        values = []
        for text in words.assignments:
            name, _, given = text.partition("=")
            target = target_of(name, self.variables)
            if target is None:
                self.variables.forget()
                return
            values.append((target, evaluate(given, self.variables) if is_sure else nan))
        for target, value in values:
            self.variables.set(target, value)

    def _follow_contour(self, words: BlockWords) -> bool:
        """Enter the contour of a cycle that is not expanded; return whether it ends here.

        How often and with which allowance its blocks are executed is not known.
        """
        if self.modes.contour is None or words.number is None:
            return False
        first, last = self.modes.contour
        if words.number == first:
            self.modes.stand(MoveFlag.CONDITIONAL, is_on=True)
        is_last = words.number == last and bool(self.recorder.standing & MoveFlag.CONDITIONAL)
        if is_last:
            self.modes.contour = None
        return is_last

    def has_plain_moves(self) -> bool:
        """True if axis words alone say where a move ends, as in most long programs."""
        modes, recorder = self.modes, self.recorder
        return (
            modes.motion in PLAIN_MOTIONS
            and modes.is_absolute is True
            and not (self.is_lathe or modes.is_diameter)
            and recorder.standing == 0
            and self.steering.is_plain
            and recorder.setting.mode is not FeedMode.INVERSE_TIME
        )

    def _plain_move(self, text: str) -> bool:
        """Execute a block of axis words, G0 or G1, and F alone; return whether it is one.

        The result is that of the words taken one by one, in a fraction of the time.
        """
        found = PLAIN.fullmatch(text)
        if found is None:
            return False
        code, *coordinates, feed = found.groups()
        if coordinates == [None, None, None]:
            return False
        modes, recorder = self.modes, self.recorder
        if code is not None:
            modes.to_motion(ModalMotion.LINE if code == "1" else ModalMotion.RAPID)
        if feed is not None:
            recorder.flags = MoveFlag.OWN_FEED.value
            modes.set_feed(float(feed), modes.scale)
        modes.set_units()
        scale = modes.scale
        end = [
            old if new is None else scale * float(new)
            for old, new in zip(recorder.at, coordinates, strict=True)
        ]
        is_rapid = modes.motion is ModalMotion.RAPID
        recorder.move(MoveKind.RAPID if is_rapid else MoveKind.LINE, end)
        return True

    def _flag(self, words: BlockWords) -> None:
        """Set the flags that concern the whole block."""
        flags = MoveFlag(0)
        if words.is_skippable:
            flags |= MoveFlag.SKIPPABLE
        if words.macros or words.evaluated:
            flags |= MoveFlag.MACRO
        if words.label or words.number in self.steering.targets:
            flags |= MoveFlag.TARGET
        if "F" in words.values or "F" in words.macros:
            flags |= MoveFlag.OWN_FEED
        if any(code not in iso_codes.KNOWN_FUNCTIONS for code in words.functions):
            flags |= MoveFlag.FIXED
        if any(name in words.values or name in words.macros for name in self.rounding(words)):
            flags |= MoveFlag.ROUNDED
        self.recorder.flags = flags.value

    def settle(self, words: BlockWords) -> None:
        """Update the modal state from the words of a block."""
        self.modes.settle(words)

    def rounding(self, words: BlockWords) -> Sequence[str]:
        """Addresses of chamfers and roundings at the end of a line."""
        is_line = 10 in words.codes or self.modes.motion is ModalMotion.LINE
        is_line = is_line and not {0, 20, 30} & set(words.codes)
        return (",C", ",R", "C", "R") if self.is_lathe and is_line else (",C", ",R")

    def _move(self, words: BlockWords) -> None:
        """Execute the axis words of the block."""
        self.modes.set_units()
        has_axes = self.has_axes(words)
        if self.modes.shot in {Shot.SHIFT, Shot.LOCAL}:
            self._shift(words)
        elif self.modes.shot in {Shot.HOME, Shot.MACHINE}:
            self._in_machine(words)
        elif self.modes.shot is Shot.OFFSETS:
            self._set_offsets(words)
        elif self.modes.shot is Shot.CENTRE:
            return
        elif self.modes.shot is Shot.DWELL:
            self._dwell(self.seconds(words))
            if self.dialect is Dialect.LINUXCNC and has_axes and not self.modes.lost:
                self._interpolate(words)
        elif ",A" in words.values or ",A" in words.macros:
            self.modes.lose("an end given by its angle ,A")
        elif self.modes.lost:
            return
        elif isinstance(self.modes.motion, CycleKind):
            if has_axes:
                self._drill(words, self.modes.motion)
        elif has_axes or self._is_circle(words):
            self._rotary(words)
            self._interpolate(words)

    def _dwell(self, seconds: float) -> None:
        if seconds < 0.0:
            self.remarks.lost(self.recorder.block, f"a dwell of {seconds:g} s")
        self.recorder.dwell(max(seconds, 0.0))

    def _set_offsets(self, words: BlockWords) -> None:
        """Take values for frames (G10 L2, L20), or for tools and other tables."""
        table = words.values.get("L", 2.0 if set("XYZ") & set(words.values) else 1.0)
        if table in {2.0, 20.0}:
            self.modes.set_frame(self.recorder.block)
        else:
            self.recorder.at = [nan, nan, nan]
            self.recorder.flags |= MoveFlag.OFFSET.value

    def seconds(self, words: BlockWords) -> float:
        """Time of a dwell, s; 0 where it is not known."""
        values = words.values
        if self.dialect is Dialect.LINUXCNC:
            return values.get("P", 0.0)
        if "P" in values:
            is_whole = "P" in words.pointless
            is_ms = self.dialect is Dialect.FANUC or is_whole
            return seconds_from_ms(values["P"]) if is_ms else values["P"]
        return values.get("X", values.get("U", 0.0))

    def has_axes(self, words: BlockWords) -> bool:
        """True if the block commands an axis."""
        letters = "XYZUWABCV"
        return any(letter in words.values or letter in words.macros for letter in letters)

    def _is_circle(self, words: BlockWords) -> bool:
        """True if the block is a full circle, which names its centre alone."""
        is_arc = self.modes.motion in {ModalMotion.CLOCKWISE, ModalMotion.COUNTERCLOCKWISE}
        return is_arc and any(letter in words.values for letter in "IJK")

    def _rotary(self, words: BlockWords) -> None:
        """Follow the rotary axes; moves beside their zero are left alone."""
        for letter in "ABC" if self.is_lathe else "ABCUVW":
            if letter in words.macros:
                self.modes.rotary[letter] = nan
            elif letter in words.values:
                before = 0.0 if self.modes.is_absolute else self.modes.rotary.get(letter, 0.0)
                self.modes.rotary[letter] = before + words.values[letter]
                self.recorder.flags |= MoveFlag.ROTARY.value
        self.modes.stand(
            MoveFlag.ROTARY, any(value != 0.0 for value in self.modes.rotary.values())
        )

    def end(self, words: BlockWords) -> list[float]:
        """End of a move by its axis words, mm."""
        return [self.coordinate(words, axis, letter) for axis, letter in enumerate("XYZ")]

    def coordinate(self, words: BlockWords, axis: int, letter: str) -> float:
        """Coordinate of one axis at the end of a move, mm."""
        at = self.recorder.at[axis]
        scale = self.modes.scale * (0.5 if axis == 0 and self.modes.is_diameter else 1.0)
        relative = {0: "U", 2: "W"}.get(axis, "") if self.is_lathe else ""
        if letter in words.macros or relative in words.macros:
            return nan
        if relative in words.values:
            return at + scale * words.values[relative]
        value = words.values.get(letter)
        if value is None:
            return at
        is_bare = letter in words.pointless and value != 0.0
        if is_bare and self.dialect in {Dialect.FANUC, Dialect.HAAS}:
            self.recorder.flags |= MoveFlag.UNPOINTED.value
        if self.modes.is_absolute is None:
            return nan
        return scale * value if self.modes.is_absolute else at + scale * value

    def _interpolate(self, words: BlockWords) -> None:
        motion, end = self.modes.motion, self.end(words)
        if motion is ModalMotion.RAPID:
            self.recorder.move(MoveKind.RAPID, end)
        elif motion is ModalMotion.LINE:
            self.recorder.move(MoveKind.LINE, end)
        elif motion in {ModalMotion.THREAD, ModalMotion.TAP}:
            self._synchronised(words, end)
        elif motion is None:
            self.remarks.lost(
                self.recorder.block, "axes move, but which motion is in force is not known"
            )
            self.recorder.unknown()
            self.recorder.at = end
        else:
            self._arc(words, end, 1.0 if motion is ModalMotion.COUNTERCLOCKWISE else -1.0)

    def _synchronised(self, words: BlockWords, end: list[float]) -> None:
        """Cut a thread to the end, and leave the hole again where the motion is a tap."""
        start, thread = self.recorder.at, self.thread(words, end)
        self.recorder.thread(end, thread)
        if self.modes.motion is ModalMotion.TAP:
            self.recorder.thread(start, thread.back)

    def thread(self, words: BlockWords, end: list[float]) -> NcThread:
        """Thread that a block cuts up to an end: K of LinuxCNC, elsewhere the feed."""
        at, word, setting = self.recorder.at, self.recorder.word, self.recorder.setting
        if self.dialect is not Dialect.LINUXCNC:
            return NcThread(lead=lead_of_word(word, setting.mode))
        lead = lead_of_path(at, end, self.modes.scale * abs(words.values.get("K", nan)))
        is_tap = self.modes.motion is ModalMotion.TAP
        return NcThread(lead=lead, speed=setting.spindle if is_tap else None)

    def _arc(self, words: BlockWords, end: list[float], sense: float) -> None:
        start, plane = self.recorder.at, self.modes.plane
        if plane is None:
            self.modes.lose("an arc in a plane that is not known")
            return
        radius = self.radius(words)
        if radius is None:
            centre = self.centre(words, plane)
        else:
            centre = centre_of_radius(start, end, radius=radius, plane=plane, sense=sense)
        turn = turn_of(start, end, centre, plane, sense=sense)
        known = [start[axis] + end[axis] for axis in plane.axes[:2]]
        if isnan(turn) and not isnan(sum(known)) and not words.macros:
            self.remarks.lost(self.recorder.block, "the arc does not fit its ends")
            self.recorder.unknown()
            self.recorder.at = end
            return
        turn += sense * self.turns(words) * FULL
        self.recorder.arc(end, centre, turn=turn, plane=plane)

    def radius(self, words: BlockWords) -> float | None:
        """Radius that the block gives for an arc, mm, or None."""
        if "R" in words.macros:
            return nan
        value = words.values.get("R")
        return None if value is None else value * self.modes.scale

    def centre(self, words: BlockWords, plane: ArcPlane) -> Point:
        """Centre of an arc by I, J and K, mm."""
        middle = list(self.recorder.at)
        for axis in plane.axes[:2]:
            letter = "IJK"[axis]
            value = self.modes.scale * words.values.get(letter, 0.0)
            if letter in words.macros or self.modes.is_centre_absolute is None:
                middle[axis] = nan
            elif self.modes.is_centre_absolute:
                half = 0.5 if axis == 0 and self.modes.is_diameter else 1.0
                middle[axis] = half * value
            else:
                middle[axis] += value
        return middle[0], middle[1], middle[2]

    def turns(self, words: BlockWords) -> int:
        """Full turns of an arc besides the one given by its ends."""
        given = words.values.get("P") if self.dialect is Dialect.LINUXCNC else None
        return 0 if given is None else max(0, min(int(given), 1000) - 1)

    def _shift(self, words: BlockWords) -> None:
        """Shift the coordinates by G92, G50 or G52."""
        end, at = self.end(words), self.recorder.at
        if not self.has_axes(words):
            return
        if self.modes.shot is Shot.LOCAL:
            given = [
                self.modes.scale * words.values[letter] if letter in words.values else old
                for letter, old in zip("XYZ", self.modes.shift, strict=True)
            ]
            self.modes.shift_to(given)
            return
        # The position gets the given coordinates: what moves is the frame.
        moved = [
            a - e if letter in words.values else 0.0
            for a, e, letter in zip(at, end, "XYZ", strict=True)
        ]
        self.modes.shift_to([old + m for old, m in zip(self.modes.shift, moved, strict=True)])
        self.recorder.at = end

    def _in_machine(self, words: BlockWords) -> None:
        """Move in coordinates of the machine: the commanded axes are unknown afterwards."""
        self.recorder.flags |= MoveFlag.MACHINE.value
        letters = "XYZ" if not self.is_lathe else "XYZUW"
        given = [
            letter for letter in letters if letter in words.values or letter in words.macros
        ]
        is_home = self.modes.shot is Shot.HOME
        axes = {"XYZ".find({"U": "X", "W": "Z"}.get(each, each)) for each in given}
        if is_home and not axes:
            axes = {0, 1, 2}
        end = [nan if axis in axes else value for axis, value in enumerate(self.recorder.at)]
        is_rapid = is_home or self.modes.motion is not ModalMotion.LINE
        self.recorder.move(MoveKind.RAPID if is_rapid else MoveKind.LINE, end)

    def _drill(self, words: BlockWords, kind: CycleKind) -> None:
        """Execute a drilling cycle at its positions."""
        if self.modes.plane is not ArcPlane.XY and not (
            self.is_lathe and kind is CycleKind.TAP
        ):
            self.modes.lose("a drilling cycle outside the XY plane is not expanded")
            return
        values, macros = words.values, words.macros
        for letter in "ZRQP":
            if letter in macros:
                self.modes.cycle[letter] = nan
            elif letter in values:
                pause = self.seconds(words) if letter == "P" else 0.0
                value = self.modes.scale * values.pop(letter)
                self.modes.cycle[letter] = pause if letter == "P" else value
        self.recorder.flags |= MoveFlag.CYCLE.value
        if (
            self.modes.is_absolute
            and "R" not in self.modes.cycle
            and "Z" not in self.modes.cycle
        ):
            self.modes.lose("a drilling cycle without Z and R")
            return
        times = min(int(values.get("L", values.get("K", 1.0))), MOST_HOLES)
        for _ in range(max(1, times)):
            self._hole(words, kind)

    def _hole(self, words: BlockWords, kind: CycleKind) -> None:
        x, y, _ = self.end(words)
        start_z = self.recorder.at[2]
        retract, depth = self.modes.cycle.get("R", start_z), self.modes.cycle.get("Z", nan)
        if not self.modes.is_absolute:
            retract = start_z + self.modes.cycle.get("R", 0.0)
            depth = retract + depth
        top = max(start_z, retract) if not isnan(start_z) else start_z
        if start_z < retract:
            self.recorder.move(MoveKind.RAPID, (*self.recorder.at[:2], retract))
        self.recorder.move(MoveKind.RAPID, (x, y, top))
        self.recorder.move(MoveKind.RAPID, (x, y, retract))
        step, dwell = (self.modes.cycle.get(letter, 0.0) for letter in "QP")
        hole = drilling(kind, (x, y), heights=(retract, depth), step=step, dwell=dwell)
        self.recorder.hole(hole, self.modes.fed_tap)
        if self.modes.returns_to_start and top != retract:
            self.recorder.move(MoveKind.RAPID, (x, y, top))
