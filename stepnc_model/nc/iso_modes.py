"""Modal state of a control in the manner of ISO 6983, and what each G code does to it."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from math import copysign, isnan, nan

from stepnc_model.nc import iso_codes
from stepnc_model.nc.block_words import BlockWords
from stepnc_model.nc.iso_motions import MODES, MOTIONS, SHOTS, ModalMotion, Shot
from stepnc_model.nc.moves import CompensationSide, FeedMode, MoveFlag
from stepnc_model.nc.recorder import MoveRecorder, frame_name
from stepnc_model.nc.thread import NcThread, tap_by_feed
from stepnc_model.post.blocks import MachineType
from stepnc_model.post.dialect import Dialect
from stepnc_model.toolpath.path import ArcPlane, CycleKind
from stepnc_model.units import (
    MM_PER_FOOT,
    MM_PER_M,
    SECONDS_PER_MINUTE,
    mm_from_inches,
    rev_s_from_rpm,
    speed_from_m_min,
)

INCH = mm_from_inches(1.0)

CodeTable = dict[int, Callable[[BlockWords], None]]
"""Action of each G code, in tenths."""


class IsoModes:
    """Modal state of one control. Running state."""

    def __init__(self, recorder: MoveRecorder, dialect: Dialect, machine: MachineType) -> None:
        self.recorder, self.dialect = recorder, dialect
        self.is_lathe = machine is MachineType.LATHE
        self.motion: ModalMotion | CycleKind | None = None
        self.plane: ArcPlane | None = ArcPlane.ZX if self.is_lathe else ArcPlane.XY
        self.is_absolute: bool | None = True
        self.is_centre_absolute: bool | None = False
        self.scale = 1.0
        """Length of one unit of the program, mm."""
        self.has_unit = False
        """Whether the program has stated its unit."""
        self.is_diameter = self.is_lathe and dialect is not Dialect.LINUXCNC
        self.returns_to_start = True
        self.shift = [0.0, 0.0, 0.0]
        self.shifted_by = 0
        """Block that shifted the frame last."""
        self.base = "G54"
        self.edition = ""
        """Words for the last block that gave values to frames."""
        self.rotary: dict[str, float] = {}
        # M3 without any S turns the spindle at a speed that the program does not tell.
        self.spindle = nan
        """Spindle word: rpm, or m/min at constant surface speed."""
        self.sense = 0.0
        self.is_surface = False
        self.limit: float | None = None
        self.tool: int | None = None
        self.tool_name = ""
        self.tap_sense = 0.0
        """Sense of the spindle in a tap, 1 or -1; 0: that in force."""
        self._straight: ModalMotion | None = None
        self.cycle: dict[str, float] = {}
        self.contour: tuple[float, float] | None = None
        """Numbers of the first and last block of the contour of a cycle (G71 P Q)."""
        self.shot: Shot | None = None
        self.pause = 0.0
        """Time of a dwell that stands in its F word, s."""
        self.lost = ""
        """Reason why the block is not understood, if any."""
        if self.is_lathe and dialect in {Dialect.FANUC, Dialect.HAAS}:
            self.to_mode(FeedMode.PER_REVOLUTION)
        self.codes = self._code_table()

    def lose(self, why: str) -> None:
        """Note that the block is not understood, so that coordinates become unknown."""
        self.lost = self.lost or why

    def forget(self) -> None:
        """Forget position and modal state, as after a program that is not here."""
        self.recorder.at = [nan, nan, nan]
        self.motion, self.plane, self.is_absolute, self._straight = None, None, None, None
        self.forget_feed()

    def forget_feed(self) -> None:
        """Forget the feed: what is in force is not known."""
        self.recorder.word, self.recorder.fed_by, self.recorder.is_fresh = nan, -1, True
        self.recorder.standing |= MoveFlag.MACRO_FEED.value

    def modal(self) -> tuple[object, ...]:
        """Position and modal state, to be compared with a later one."""
        recorder = self.recorder
        feed = recorder.fed_by, recorder.setting.mode
        return tuple(recorder.at), feed, self.motion, self.plane, self.is_absolute, self.scale

    def forget_changed(self, changed: set[int]) -> None:
        """Forget the parts of the modal state with these indices; the position is lost."""
        if 1 in changed:
            self.forget_feed()
        if 2 in changed:
            self.motion = None
        if 3 in changed:
            self.plane = None
        if 4 in changed:
            self.is_absolute = None
        if 5 in changed:
            self.scale = nan

    # Modal words.

    def settle(self, words: BlockWords) -> None:
        """Update the modal state from the G codes and the F word."""
        unit = self.scale
        for code in words.codes:
            act = self.codes.get(code)
            if act is None:
                self.lose(f"G{code / 10:g} is not known")
                self.motion = None
            else:
                act(words)
        if self.recorder.setting.mode is FeedMode.INVERSE_TIME and "F" not in words.values:
            self.recorder.word = nan
        if self.dialect is not Dialect.LINUXCNC:
            unit = self.scale
        elif unit != self.scale and "F" in words.values:
            # LinuxCNC takes F before the units of its block.
            self.recorder.flags |= MoveFlag.MACRO_FEED.value
        self.feed(words, unit)

    def feed(self, words: BlockWords, unit: float) -> None:
        """Take the F word in units of a length in mm."""
        if self.shot is Shot.DWELL and self.dialect is Dialect.SINUMERIK:
            self.pause = words.values.pop("F", 0.0)
            return
        value = words.values.pop("F", None)
        if "F" in words.macros:
            self.forget_feed()
            self.recorder.fed_by = self.recorder.block
        elif value is not None:
            self.set_feed(value, unit)

    def set_feed(self, value: float, unit: float) -> None:
        """Put the number of an F word in force, in units of a length in mm."""
        recorder = self.recorder
        per_minute = recorder.setting.mode is FeedMode.PER_MINUTE
        is_inverse = recorder.setting.mode is FeedMode.INVERSE_TIME
        scale = 1.0 if is_inverse else unit
        divisor = SECONDS_PER_MINUTE if per_minute or is_inverse else 1.0
        recorder.word = value * scale / divisor
        recorder.fed_by, recorder.is_fresh = recorder.block, True
        recorder.standing &= ~MoveFlag.MACRO_FEED.value

    def _code_table(self) -> CodeTable:
        """Actions of the G codes of this control."""
        control = self.dialect
        table: CodeTable = {}
        for code in iso_codes.HARMLESS | iso_codes.HARMLESS_BY_CONTROL[control]:
            table[code] = _nothing
        for code, motion in MOTIONS.items():
            table[code] = partial(self._take_motion, motion)
        for code, plane in iso_codes.PLANES.items():
            table[code] = partial(self._take, "plane", plane)
        for code, shot in SHOTS.items():
            table[code] = partial(self._take, "shot", shot)
        for code in iso_codes.FRAMES_BY_CONTROL[control]:
            table[code] = partial(self._take_frame, f"G{code / 10:g}")
        for code in iso_codes.LENGTHS:
            table[code] = self.lose_height
        for codes, is_on in (
            (iso_codes.TRANSFORMS_ON[control], True),
            (iso_codes.TRANSFORMS_OFF[control], False),
        ):
            for code in codes:
                centred = code in iso_codes.CENTRED_TRANSFORMS
                table[code] = partial(self._take_transform, is_on, centred)
        table |= {
            **{code: partial(self.to_mode, mode) for code, mode in MODES.items()},
            **{code: partial(self._compensate, code) for code in (400, 410, 420)},
            200: partial(self._take_unit, INCH),
            210: partial(self._take_unit, 1.0),
            900: partial(self._take, "is_absolute", True),
            910: partial(self._take, "is_absolute", False),
            960: self._surface_speed,
            970: partial(self._take, "is_surface", False),
            90: self._exact,
        }
        return table | self.own_codes()

    def own_codes(self) -> CodeTable:
        """Actions of the G codes in which mills, lathes and controls differ."""
        table: CodeTable = {}
        is_linuxcnc = self.dialect is Dialect.LINUXCNC
        if self.is_lathe and not is_linuxcnc:
            table |= {
                980: partial(self.to_mode, FeedMode.PER_MINUTE),
                990: partial(self.to_mode, FeedMode.PER_REVOLUTION),
                320: partial(self._take_motion, ModalMotion.THREAD),
                500: self._lathe_shift,
            }
            for code in iso_codes.LATHE_CYCLES:
                table[code] = partial(self._not_expanded, code)
            table |= {920: self._thread_or_limit, 840: partial(self._take_tap, 1.0)}
            if self.dialect is Dialect.HAAS:
                table[1840] = partial(self._take_tap, -1.0)
        else:
            for code, kind in iso_codes.CANNED.items():
                table[code] = partial(self._take_motion, kind)
            table |= {code: partial(self._take_tap, s) for code, s in ((740, -1.0), (840, 1.0))}
            for code in iso_codes.UNKNOWN_CYCLES:
                table[code] = partial(self._not_expanded, code)
            table |= {
                980: partial(self._take, "returns_to_start", True),
                990: partial(self._take, "returns_to_start", False),
            }
        if is_linuxcnc:
            table |= self._linuxcnc_codes()
        table[800] = self._cancel
        return table | dict.fromkeys(iso_codes.NUMBERED_FRAMES, self._numbered_frame)

    def _linuxcnc_codes(self) -> CodeTable:
        return {
            70: partial(self._take, "is_diameter", True),
            80: partial(self._take, "is_diameter", False),
            331: partial(self._take_motion, ModalMotion.TAP),
            411: partial(self._compensate, 411),
            421: partial(self._compensate, 421),
            901: partial(self._take, "is_centre_absolute", True),
            911: partial(self._take, "is_centre_absolute", False),
            921: partial(self._take_shift, 0.0),
            922: partial(self._take_shift, 0.0),
            923: partial(self._take_shift, nan),
        }

    def _take(self, name: str, value: object, _: BlockWords) -> None:
        """Set one part of the modal state."""
        setattr(self, name, value)

    def _take_unit(self, scale: float, _: BlockWords) -> None:
        self.scale, self.has_unit = scale, True

    def _take_motion(self, motion: ModalMotion | CycleKind, _: BlockWords) -> None:
        self.to_motion(motion)

    def _take_tap(self, sense: float, _: BlockWords) -> None:
        self.tap_sense = sense
        self.to_motion(CycleKind.TAP)

    def to_motion(self, motion: ModalMotion | CycleKind) -> None:
        """Change the motion that axis words execute."""
        if motion is not self.motion:
            self.cycle = {}
        if isinstance(motion, ModalMotion):
            self._straight = motion
        self.motion = motion

    def _take_frame(self, name: str, words: BlockWords) -> None:
        is_numbered = "P" in words.values and 40 not in words.codes
        if name == "G54" and is_numbered and self.dialect is Dialect.FANUC:
            # Fanuc takes G54 P5 for G54.1 P5.
            self._numbered_frame(words)
        else:
            self.to_frame(name)

    def _take_transform(self, is_on: bool, is_centred: bool, _: BlockWords) -> None:
        self.transform(is_on)
        if is_centred:
            self.shot = Shot.CENTRE

    def _take_shift(self, value: float, _: BlockWords) -> None:
        self.shift_to([value] * 3)

    def _not_expanded(self, code: int, words: BlockWords) -> None:
        self.lose(f"the cycle G{code / 10:g} is not expanded")
        self.motion = None
        if self.is_lathe and "P" in words.values and "Q" in words.values:
            self.contour = words.values["P"], words.values["Q"]

    def _cancel(self, _: BlockWords) -> None:
        if isinstance(self.motion, CycleKind):
            # Elsewhere cycles are a group of their own: the motion before them is in force.
            self.motion = None if self.dialect is Dialect.LINUXCNC else self._straight

    def to_mode(self, mode: FeedMode, _: BlockWords | None = None) -> None:
        """Change the reference of F words, after which no feed is in force."""
        if self.recorder.setting.mode is mode:
            return
        self.recorder.setting = replace(self.recorder.setting, mode=mode)
        self.recorder.word, self.recorder.fed_by = nan, -1

    def _compensate(self, code: int, words: BlockWords) -> None:
        """Begin compensation to the left or right of the contour, or end it (G40)."""
        side = None
        if code != 400:
            own = code % 10 == 1
            given = words.values.get("D")
            side = CompensationSide(
                is_left=code < 420,
                plane=self.plane or ArcPlane.XY,
                number=None if given is None or own else int(given),
                diameter=self.scale * (nan if given is None else given) if own else None,
            )
        was_on = bool(self.recorder.standing & MoveFlag.COMPENSATED)
        self.stand(MoveFlag.COMPENSATED, side is not None)
        self.recorder.setting = replace(self.recorder.setting, side=side)
        # The move after G40 begins beside its commanded start.
        if was_on and side is None:
            self.recorder.carry(MoveFlag.COMPENSATED)

    def transform(self, is_on: bool) -> None:
        """Begin or end rotated, scaled, mirrored or polar coordinates."""
        was_on = bool(self.recorder.standing & MoveFlag.TRANSFORMED)
        self.stand(MoveFlag.TRANSFORMED, is_on)
        if is_on or was_on:
            self.recorder.at = [nan, nan, nan]

    def stand(self, flag: MoveFlag, is_on: bool) -> None:
        """Set or take away a flag of all moves from here."""
        if is_on:
            self.recorder.standing |= flag.value
        else:
            self.recorder.standing &= ~flag.value

    def _exact(self, _: BlockWords) -> None:
        self.recorder.flags |= MoveFlag.EXACT.value

    def lose_height(self, _: BlockWords | None = None) -> None:
        """Forget z, as after a change of the tool's length offset."""
        self.recorder.lose(2)
        self.recorder.flags |= MoveFlag.OFFSET.value

    # Frames.

    def to_frame(self, name: str) -> None:
        """Change to another frame, in which the position is not known yet."""
        self.recorder.flags |= MoveFlag.OFFSET.value
        if name != self.base:
            self.base = name
            self.recorder.at = [nan, nan, nan]
        self._name_frame()

    def shift_to(self, shift: list[float]) -> None:
        """Shift the coordinates of the frame."""
        at = self.recorder.at
        self.recorder.at = [a + o - s for a, o, s in zip(at, self.shift, shift, strict=True)]
        self.shift, self.shifted_by = shift, self.recorder.block
        self.recorder.flags |= MoveFlag.OFFSET.value
        self._name_frame()

    def set_frame(self, block: int) -> None:
        """Take new values for frames by G10: what follows stands in a frame of its own."""
        self.recorder.flags |= MoveFlag.OFFSET.value
        self.recorder.at = [nan, nan, nan]
        self.edition = f" as set in block {block + 1}"
        self._name_frame()

    def _name_frame(self) -> None:
        name = frame_name(f"{self.base}{self.edition}", self.shift, self.shifted_by)
        setting = self.recorder.setting
        self.recorder.setting = replace(setting, frame=self.recorder.frame(name))

    def _numbered_frame(self, words: BlockWords) -> None:
        number = words.values.pop("P", nan)
        if isnan(number):
            self.recorder.at = [nan, nan, nan]
        self.to_frame(f"G54.1 P{number:g}")

    def _thread_or_limit(self, words: BlockWords) -> None:
        """Take G92: a threading cycle, or the limit of the speed (G92 S) like G50 S."""
        if "S" in words.values and not set("XZUW") & {*words.values, *words.macros}:
            self._lathe_shift(words)
        else:
            self._not_expanded(920, words)

    def _lathe_shift(self, words: BlockWords) -> None:
        """Limit the speed of the spindle (G50 S), or shift the coordinates (G50 X Z)."""
        if not set("XZUW") & (set(words.values) | set(words.macros)):
            self._take_limit(words)
        else:
            self.shot = Shot.SHIFT

    # Spindle and tool.

    def _surface_speed(self, words: BlockWords) -> None:
        self.is_surface = True
        limit = words.values.pop("D", None)
        if self.dialect is Dialect.LINUXCNC:
            self.limit = None if limit is None else rev_s_from_rpm(limit)

    def _take_limit(self, words: BlockWords) -> None:
        limit = words.values.pop("S", None)
        self.limit = None if limit is None else rev_s_from_rpm(limit)

    def turn(self, words: BlockWords) -> None:
        """Take S, M3, M4 and M5."""
        if self.shot is Shot.SHIFT and "S" in words.values:
            self._take_limit(words)
        speed = words.values.pop("S", None)
        if speed is not None and speed < 0.0:
            self.lose(f"a spindle speed of {speed:g}")
        if "S" in words.macros:
            self.spindle = nan
        elif speed is not None:
            self.spindle = speed
        for code, sense in ((30, 1.0), (40, -1.0), (50, 0.0), (130, 1.0), (140, -1.0)):
            if code in words.functions:
                self.sense = sense
        self.turn_spindle()

    @property
    def tapping_speed(self) -> float | None:
        """Speed of a tap, rev/s, signed: it turns the spindle itself; None: that in force."""
        if self.is_surface:
            return None
        return copysign(rev_s_from_rpm(self.spindle), self.tap_sense or self.sense or 1.0)

    @property
    def fed_tap(self) -> NcThread:
        """Tap whose lead follows from the feed in force."""
        recorder = self.recorder
        return tap_by_feed(recorder.word, recorder.setting.mode, speed=self.tapping_speed)

    def turn_spindle(self) -> None:
        """Bring the setting in line with the spindle words."""
        is_surface = self.is_surface and self.sense != 0.0
        surface = speed_from_m_min(self.spindle)
        if self.scale != 1.0:
            surface *= MM_PER_FOOT / MM_PER_M
        speed = self.sense * (1.0 if is_surface else rev_s_from_rpm(self.spindle))
        speed = speed if self.sense != 0.0 else 0.0
        setting = self.recorder.setting
        wanted = (
            None if isnan(speed) else speed + 0.0,
            surface if is_surface and not isnan(surface) else None,
            self.limit if is_surface else None,
        )
        if wanted != (setting.spindle, setting.surface, setting.limit):
            self.recorder.setting = replace(
                setting, spindle=wanted[0], surface=wanted[1], limit=wanted[2]
            )

    def take_tool(self, words: BlockWords) -> None:
        """Take T and M6; on the lathes of Fanuc and Haas T alone turns the turret."""
        number = words.values.pop("T", None)
        is_macro = "T" in words.macros
        if is_macro:
            self.tool, self.tool_name = None, ""
        elif number is not None:
            self.tool, self.tool_name = int(number), ""
        if self.is_lathe and self.dialect in {Dialect.FANUC, Dialect.HAAS}:
            if self.tool is not None and number is not None:
                self.to_tool(self.tool // 100 if self.tool >= 100 else self.tool)
            elif is_macro:
                self.to_tool(None)
        elif 60 in words.functions:
            self.to_tool(self.tool)
        elif 610 in words.functions and self.dialect is Dialect.LINUXCNC:
            # M61 Q5 says which tool is in the spindle.
            called = words.values.pop("Q", nan)
            self.tool, self.tool_name = None if isnan(called) else int(called), ""
            self.to_tool(self.tool)
        if 720 in words.functions and self.dialect is Dialect.LINUXCNC:
            self.lose("M72 restores a state that is not kept here")
            self.forget()

    def to_tool(self, number: int | None) -> None:
        """Change the tool, after which its height is not known."""
        setting = self.recorder.setting
        self.recorder.setting = replace(setting, tool=number, tool_name=self.tool_name)
        self.recorder.lose(*((0, 1, 2) if self.is_lathe else (2,)))

    # Moves.

    def set_units(self) -> None:
        """Bring the setting in line with units and modes of coordinates."""
        setting = self.recorder.setting
        relative, central = not self.is_absolute, bool(self.is_centre_absolute)
        now = (
            setting.unit,
            setting.is_diameter,
            setting.is_relative,
            setting.is_centre_absolute,
        )
        if now != (self.scale, self.is_diameter, relative, central):
            self.recorder.setting = replace(
                setting,
                unit=self.scale,
                is_diameter=self.is_diameter,
                is_relative=relative,
                is_centre_absolute=central,
            )


def _nothing(_: BlockWords) -> None:
    """Action of a G code that moves and changes nothing here."""
