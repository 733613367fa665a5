"""What blocks do between moves: tools, spindle, coolant, comments, stops; and what is unread.

After LinuxCNC "M Codes", Fanuc B-64604EN, Haas "Mill Operator's Manual" and Siemens "SINUMERIK
840D sl Fundamentals": M3, M4, M7 and M8 act before the move of their block, M0 to M2 and M30
after it.
"""

from collections.abc import Iterable, Iterator
from math import inf

from stepnc_model.nc.block_words import BlockWords
from stepnc_model.nc.iso_codes import PLANES
from stepnc_model.nc.iso_flow import AXES
from stepnc_model.nc.iso_modes import IsoModes
from stepnc_model.nc.iso_motions import MODES, MOTIONS, ModalMotion, Shot
from stepnc_model.nc.recorder import MoveRecorder
from stepnc_model.nc.remarks import Remarks
from stepnc_model.nc.spindle import spindle_block
from stepnc_model.post.blocks import (
    Block,
    Comment,
    Coolant,
    CoolantKind,
    Message,
    OptionalStopBlock,
    PathControl,
    ProgramEnd,
    ProgramStopBlock,
    SpindleOff,
    SpindleOrient,
    ToolChange,
)
from stepnc_model.post.dialect import Dialect
from stepnc_model.toolpath.path import CycleKind

STOPS: dict[int, Block] = {
    0: ProgramStopBlock(),
    10: OptionalStopBlock(),
    20: ProgramEnd(),
    300: ProgramEnd(),
}
"""Stops by their M codes, in tenths."""

STARTS = {30, 40, 130, 140}
"""M codes that turn the spindle."""

COOLANT_ON = {
    70: CoolantKind.MIST,
    80: CoolantKind.FLOOD,
    130: CoolantKind.FLOOD,
    140: CoolantKind.FLOOD,
}
HAAS_THROUGH = {880: CoolantKind.THROUGH}
COOLANT_OFF = {90: frozenset({CoolantKind.MIST, CoolantKind.FLOOD})}
HAAS_THROUGH_OFF = {890: frozenset({CoolantKind.THROUGH})}

COMMON = {*STOPS, *STARTS, *COOLANT_ON, *COOLANT_OFF, 50, 60, 190}
"""M codes that all controls know."""

OWN = {
    Dialect.LINUXCNC: {520, 610},
    Dialect.FANUC: {290, 970, 980, 990},
    Dialect.HAAS: {290, 880, 890, 970, 980, 990},
    Dialect.SINUMERIK: {170},
}
"""Further M codes that are read: tools and taps, calls and returns, adaptive feed (M52)."""

SPEEDS = {500, 960, 961, 970, 9610}
"""G codes that change what S says."""

GROUPS = ((MOTIONS, "motions"), (PLANES, "planes"), (MODES, "references of F"))
"""G codes of which a block has one."""

PATH_CONTROL = {610, 611, 640}
"""G codes of corners: exact path, exact stop, continuous."""

ARCS = {ModalMotion.CLOCKWISE, ModalMotion.COUNTERCLOCKWISE}


class SwitchRecorder:
    """Recorder of the switches that all controls share. Running state."""

    def __init__(self, recorder: MoveRecorder, remarks: Remarks, dialect: Dialect) -> None:
        self._recorder, self._remarks, self._dialect = recorder, remarks, dialect
        is_haas = dialect is Dialect.HAAS
        self._on = COOLANT_ON | (HAAS_THROUGH if is_haas else {})
        self._off = COOLANT_OFF | (HAAS_THROUGH_OFF if is_haas else {})
        self._coolant: frozenset[CoolantKind] = frozenset()

    def comment(self, text: str) -> None:
        """Record a comment as it is written, whose bytes are characters so far."""
        if text.startswith("("):
            if not text.endswith(")"):
                self.unread("a comment without its end")
            text = text[1:].removesuffix(")")
        elif text.startswith("*"):
            text = text.lstrip("*").strip().removeprefix("-")
        else:
            text = text[1:]
        if self._dialect is Dialect.LINUXCNC and text.upper().startswith("MSG,"):
            self.message(text[4:])
        else:
            self._recorder.switch(Comment(text=_decoded(text)))

    def message(self, text: str) -> None:
        """Record a message to the operator."""
        self._recorder.switch(Message(text=_decoded(text)))

    def tool(self) -> None:
        """Record that the tool in force is brought into the spindle."""
        setting = self._recorder.setting
        if setting.tool is not None:
            self._recorder.switch(ToolChange(number=setting.tool))
        elif not setting.tool_name:
            self.unread("a tool change without a tool number T")

    def spindle(self, *, starts: bool) -> None:
        """Record that the spindle starts, or is brought to what is in force."""
        block = spindle_block(self._recorder.setting)
        if starts and (block is None or isinstance(block, SpindleOff)):
            self.unread("the spindle starts without a speed S")
        elif block is not None:
            self._recorder.switch(block)

    def before_move(self, functions: Iterable[int]) -> None:
        """Record coolant and orientation of the spindle."""
        old = self._coolant
        for code in functions:
            if code in self._off:
                self._coolant -= self._off[code]
            elif code in self._on:
                self._coolant |= {self._on[code]}
            elif code == 190:
                self._recorder.switch(SpindleOrient())
        if self._coolant != old:
            self._recorder.switch(Coolant(kinds=self._coolant))

    def after_move(self, functions: Iterable[int]) -> None:
        """Record stops and the end of the program."""
        for code in functions:
            if code in STOPS:
                self._recorder.switch(STOPS[code])

    def unread(self, why: str) -> None:
        """Note what a block says beyond its moves and switches."""
        self._remarks.unread(self._recorder.block, why)


def _decoded(text: str) -> str:
    """Text of a comment, in which each byte is a character."""
    return text.encode("latin-1", "replace").decode("utf-8", "replace").strip()


class IsoSwitches(SwitchRecorder):
    """Recorder of switches in the manner of ISO 6983. Running state."""

    def __init__(self, modes: IsoModes, remarks: Remarks) -> None:
        super().__init__(modes.recorder, remarks, modes.dialect)
        self._modes = modes
        self._known = COMMON | OWN[modes.dialect]
        self._is_stopped = False
        """Whether a change of tools has stopped the spindle."""

    def settled(self, words: BlockWords) -> None:
        """Change tools, turn the spindle, and record both with the other switches."""
        modes, functions = self._modes, words.functions
        is_turning = "S" in words.values or bool(SPEEDS & set(words.codes))
        number, before = words.values.get("T"), self._recorder.setting
        modes.take_tool(words)
        if number is not None and number != int(number):
            self.unread(f"T{number:g}: tools have whole numbers")
        if self._recorder.setting is not before:
            self._is_stopped = True
            self.tool()
        modes.turn(words)
        starts = bool(STARTS & set(functions))
        self._is_stopped &= not starts
        is_turning = (starts or is_turning) and modes.sense != 0.0 and not self._is_stopped
        if 50 in functions or is_turning:
            self.spindle(starts=starts)
        if "SPOS" in words.values:
            functions = [*functions, 190]
            if words.values.pop("SPOS"):
                self.unread("SPOS: angles other than 0 are not read")
        self._path_control(words)
        self.before_move(functions)

    def _path_control(self, words: BlockWords) -> None:
        """Record how LinuxCNC runs from one move into the next; P0 is no tolerance there."""
        codes = PATH_CONTROL & set(words.codes)
        if self._dialect is not Dialect.LINUXCNC or not codes:
            return
        if 640 not in codes:
            found = PathControl(tolerance=0.0, is_exact_stop=611 in codes)
        else:
            scale, values = self._modes.scale, words.values
            joining = values.get("Q")
            found = PathControl(
                tolerance=values.get("P", 0.0) * scale or inf,
                joining=None if joining is None else joining * scale,
            )
        self._recorder.switch(found)

    def moved(self, words: BlockWords) -> None:
        """Record stops after the move, and note what no part of the block has used."""
        self.after_move(words.functions)
        for code in words.functions:
            if code not in self._known:
                self.unread(f"M{code / 10:g} is not known")
        for group, what in GROUPS:
            if sum(code in group for code in words.codes) > 1:
                self.unread(f"two {what} in one block")
        if sum(code in STARTS or code == 50 for code in words.functions) > 1:
            self.unread("two commands of the spindle in one block")
        left = {*words.values, *words.macros} - set(self._used(words))
        if left:
            self.unread(f"{', '.join(sorted(left))}: not used by this block")
        has_time = self._dialect is Dialect.SINUMERIK or set("PXU") & set(words.values)
        if self._modes.shot is Shot.DWELL and not has_time:
            self.unread("a dwell without its time")
        cycle, kind = self._modes.cycle, self._modes.motion
        if cycle and kind in {CycleKind.PECK, CycleKind.CHIP_BREAK} and not cycle.get("Q"):
            self.unread("a peck drilling cycle without Q")

    def _used(self, words: BlockWords) -> Iterator[str]:
        """Addresses that the block takes."""
        modes, codes = self._modes, set(words.codes)
        is_linuxcnc = self._dialect is Dialect.LINUXCNC
        # Moves of other axes are flagged.
        yield from "XZUWABCON" if modes.is_lathe else "XYZUVWABCON"
        if modes.shot is Shot.DWELL:
            yield from "PXU"
        if modes.motion in ARCS:
            yield from ("R", "TURN", "CR")
            # Posts write a 0 for the axis along the normal as well.
            normal = "" if modes.plane is None else "IJK"[modes.plane.axes[2]]
            yield from (each for each in "IJK" if each != normal or not words.values.get(each))
            yield from "P" if is_linuxcnc else ""
        elif isinstance(modes.motion, CycleKind):
            yield from "RQPLK"
        elif modes.motion in {ModalMotion.THREAD, ModalMotion.TAP} and AXES & {*words.values}:
            yield from "IJKF"
        if 430 in codes:
            yield "H"
        if self._dialect is Dialect.SINUMERIK or {410, 411, 420, 421} & codes:
            yield "D"
        if is_linuxcnc and PATH_CONTROL & codes:
            yield from "PQ"
        if is_linuxcnc and 520 in words.functions:
            yield "P"
