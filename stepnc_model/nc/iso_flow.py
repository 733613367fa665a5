"""Flow of programs in the manner of ISO 6983: subprograms, repeats and conditions.

Conditions whose variables are known are evaluated, and loops run, within a bound. Blocks of
other conditions are executed once, and what they change is unknown afterwards.
"""

import re
from math import isnan
from typing import Protocol

from stepnc_model.nc.block_words import BlockWords, words_of
from stepnc_model.nc.conditional_value import forget_assigned
from stepnc_model.nc.expression import Variables, evaluate
from stepnc_model.nc.flow import BEHIND_THE_END, ProgramFlow, places
from stepnc_model.nc.flow_keywords import keyword_places, loop_places
from stepnc_model.nc.moves import MoveFlag
from stepnc_model.nc.recorder import MoveRecorder
from stepnc_model.nc.remarks import Remarks
from stepnc_model.nc.text import NcText
from stepnc_model.post.dialect import Dialect


class Steered(Protocol):
    """Control whose program is steered."""

    text: NcText
    dialect: Dialect
    recorder: MoveRecorder
    remarks: Remarks
    flow: ProgramFlow
    variables: Variables

    def assign(self, words: BlockWords) -> None:
        """Set the variables of a block."""
        ...

    def forget(self) -> None:
        """Forget position and modal state."""
        ...

    def modal(self) -> tuple[object, ...]:
        """Position and modal state, to be compared with a later one."""
        ...

    def forget_changed(self, changed: set[int]) -> None:
        """Forget the parts of the modal state with these indices."""
        ...


PROGRAMS = re.compile(rb"^[ \t]*/?[ \t]*(?:N[0-9]+[ \t]*)?[O:][ \t]*([0-9]+)", re.M | re.I)
SUBPROGRAMS = re.compile(rb"^[ \t]*o[ \t]*([0-9]+|<[^>\r\n]*>)[ \t]*sub\b", re.M | re.I)
ENDS = re.compile(rb"^[ \t]*o[ \t]*([0-9]+|<[^>\r\n]*>)[ \t]*endsub\b", re.M | re.I)
LOCAL = re.compile(rb"^[ \t]*N([0-9]+)", re.M | re.I)
JUMPS = re.compile(rb"M97|M99[ \t]*P|GOTO", re.I)
STATEMENT = re.compile(r"o\s*([0-9]+|<[^>]*>|\S+?)\s*([a-z]+)\s*(.*)", re.I | re.S)
COUNT = re.compile(r"\[?\s*([0-9]+)(?:\.0*)?\s*\]?")

RETURN = re.compile(r"M0*99(?![0-9])", re.I)

END_OF_PROGRAM = {20, 300}
CALLS = {970, 980, 990}
"""M97, M98 and M99."""

AXES = frozenset("XYZUVWABC")

BRACKETS = re.compile(r"\[(?:[^\[\]]|\[(?:[^\[\]]|\[(?:[^\[\]]|\[[^\[\]]*\])*\])*\])*\]")
FANUC_LOOP = re.compile(r"WHILE\s*(\[.*\])\s*DO\s*([0-9]+)\s*", re.I | re.S)
FANUC_JUMP = re.compile(r"(?:IF\s*(\[.*\])\s*)?GOTO\s*([0-9]+)\s*", re.I | re.S)
FANUC_THEN = re.compile(r"IF\s*(\[.*\])\s*THEN\s*(#.*=.*)", re.I | re.S)
FANUC_END = re.compile(r"END\s*([0-9]+)\s*", re.I)
ARGUMENTS = {
    **{"A": 1, "B": 2, "C": 3, "I": 4, "J": 5, "K": 6, "D": 7, "E": 8, "F": 9, "H": 11},
    **{"M": 13, "Q": 17, "R": 18, "S": 19, "T": 20, "U": 21, "V": 22, "W": 23, "X": 24},
    **{"Y": 25, "Z": 26},
}
"""Local variables of the arguments of G65."""


class IsoFlow:
    """Steering of one program. Running state."""

    def __init__(self, control: Steered) -> None:
        self._control = control
        self._text, self._flow = control.text, control.flow
        self._is_linuxcnc = control.dialect is Dialect.LINUXCNC
        pattern = SUBPROGRAMS if self._is_linuxcnc else PROGRAMS
        self._programs = dict(reversed(list(places(self._text, pattern))))
        self._ends = dict(places(self._text, ENDS)) if self._is_linuxcnc else {}
        self._numbers: dict[str, int] = {}
        self._numbered: list[tuple[str, int]] = []
        if not self._is_linuxcnc and JUMPS.search(self._text.data):
            self._numbered = list(places(self._text, LOCAL))
            self._numbers = dict(reversed(self._numbered))
        self.targets: set[int | None] = set()
        """Block numbers that jumps may lead to."""
        self._repeats: dict[str, int] = {}
        self._times: dict[int, int] = {}
        self._open: list[tuple[str, str]] = []
        self._before: tuple[object, ...] | None = None
        self._changed: set[int] = set()
        self._is_begun = False
        self._percents = 0
        self._variables = control.variables
        self._keywords = keyword_places(self._text) if self._is_linuxcnc else {}
        self._loops = {} if self._is_linuxcnc else loop_places(self._text)
        self._starts = sorted(self._programs.values())
        self._branches: dict[str, bool] = {}
        """Whether a branch was taken, of the conditions that are evaluated."""
        self._begun: dict[str, int] = {}
        """First block of the loops that are evaluated."""
        self._number: float | None = None
        """P of a block that calls or returns."""
        self._times_called: float | None = None
        """L of such a block."""
        self.keeps_state: frozenset[int] = frozenset()
        """Programs outside the file that keep the modal state, as the user says."""
        self._entered: set[int] = set()
        """Blocks at which called subprograms begin."""

    def follow(self, words: BlockWords, block: int) -> int | None:
        """Next block if this one only steers the program, else None."""
        if words.is_percent and words.is_empty:
            self._percents += 1
            return len(self._text) if self._is_begun and self._percents > 1 else block + 1
        if not words.is_empty:
            begun, self._is_begun = self._is_begun, True
            number = words.values.get("O")
            if number is not None and not self._is_linuxcnc:
                return self._named(begun, block)
        if words.flows:
            return self.statement(words.flows[0], block)
        if 650 in words.codes:
            return self._macro_called(words, block)
        if 660 in words.codes:
            return self._outside(block, "a macro call")
        if 1980 in words.functions:
            return self._outside(block, "a program that is not in this file is called")
        if CALLS & set(words.functions):
            self._number, self._times_called = (words.values.pop(a, None) for a in "PL")
            # The other words of the block come first: G55 M98 P2, or G90 M99.
            others = words.codes or words.values or words.macros or words.functions[1:]
            return None if others else self._steered(words, block)
        return None

    def ended(self, words: BlockWords, block: int) -> int:
        """Block after this one, which may call, return, or end the program."""
        if CALLS & set(words.functions):
            return self._steered(words, block)
        if END_OF_PROGRAM & set(words.functions) and not self._open:
            return len(self._text)
        return block + 1

    @property
    def is_plain(self) -> bool:
        """True if the program has begun and no condition is open."""
        return self._is_begun and self._before is None

    def watch(self) -> None:
        """Remember what a condition changes."""
        if self._before is not None:
            self._note_changes()

    @property
    def _is_conditional(self) -> bool:
        return bool(self._control.recorder.standing & MoveFlag.CONDITIONAL)

    def _named(self, is_begun: bool, block: int) -> int:
        """Pass the head of a program; the next program ends the one before it."""
        if not is_begun or not self._control.recorder.count:
            return block + 1
        if self._flow.is_called:
            return block + 1
        return len(self._text)

    def _steered(self, words: BlockWords, block: int) -> int:
        """Call a subprogram or return from one; return the block to execute next."""
        is_call = bool({970, 980} & set(words.functions))
        return self._called(words, block) if is_call else self._returned(block)

    def _called(self, words: BlockWords, block: int) -> int:
        """Call a subprogram by M98, or by M97 at a block number."""
        number = self._number
        times = 1 if self._times_called is None else int(self._times_called)
        if number is None:
            return self._outside(block, "a call without P")
        is_local = 970 in words.functions
        target = self._target(number, is_local=is_local)
        if target is None and not is_local and number >= 10_000:
            times, number = int(number // 10_000), number % 10_000
            target = self._target(number, is_local=False)
        if target is None:
            why = f"the subprogram {number:g} is not in this file"
            return self._outside(block, why, number=number)
        if self._is_conditional and self._flow.is_inside(target):
            return self._outside(block, "a call of itself")
        self._entered.add(target)
        if times > 0:
            self._variables.enter(None)
        return self._flow.call(block, target, times=times)

    def _macro_called(self, words: BlockWords, block: int) -> int:
        """Call a subprogram with arguments by G65."""
        number, times = words.values.get("P"), int(words.values.get("L", 1.0))
        target = None if number is None else self._target(number, is_local=False)
        if target is None or times < 1:
            return self._outside(block, "a macro call", number=number)
        if self._is_conditional and self._flow.is_inside(target):
            return self._outside(block, "a call of itself")
        self._entered.add(target)
        given = words.values.items()
        self._variables.enter({ARGUMENTS[name]: v for name, v in given if name in ARGUMENTS})
        return self._flow.call(block, target, times=times)

    def _leave(self) -> int | None:
        """Return from a subprogram, or execute it again."""
        depth = self._flow.depth
        following = self._flow.leave()
        if self._flow.depth < depth:
            self._variables.leave()
        return following

    def remark_rest(self, block: int) -> None:
        """Remark the first moves behind the end of the program that no call executes."""
        heads = sorted(self._programs.values())
        size = len(self._text)
        while block < size:
            text = self._text.block(block)
            if block in self._entered:
                inside = block
                if block in heads:
                    block = next((each for each in heads if each > inside), size)
                else:
                    while block < size and not RETURN.search(self._text.block(block)):
                        block += 1
                    block += 1
                continue
            words = words_of(text, self._control.dialect)
            found = STATEMENT.fullmatch(words.flows[0]) if words.flows else None
            if self._is_linuxcnc and found is not None and found[2].lower() == "sub":
                block = self._ends.get(found[1].upper(), size) + 1
                continue
            if AXES & {*words.values, *words.macros}:
                self._control.remarks.warn(block, BEHIND_THE_END)
                return
            block += 1

    def _target(self, number: float, *, is_local: bool) -> int | None:
        found = self._numbers if is_local else self._programs
        for name, block in found.items():
            if int(name) == int(number):
                return block
        return None

    def _returned(self, block: int) -> int:
        """Return from a subprogram; the main program ends, where a control begins anew."""
        if self._number is not None:
            self._control.remarks.lost(block, "a return to another block")
            self._begin_condition()
        following = self._leave()
        return len(self._text) if following is None else following

    def _outside(self, block: int, why: str, *, number: float | None = None) -> int:
        """Pass a call of something that is not here."""
        self._control.recorder.unknown()
        self._variables.forget()
        if number in self.keeps_state:
            kept = f"the program {number:g} keeps the modal state, as given; its moves are open"
            self._control.remarks.note(block, kept)
            return block + 1
        hint = "" if number is None else f"; --keeps-state P{number:g} if it keeps the state"
        self._control.remarks.lost(block, why + hint)
        self._control.forget()
        return block + 1

    def statement(self, text: str, block: int) -> int:
        """Execute a statement that steers the program; return the next block."""
        found = STATEMENT.fullmatch(text) if self._is_linuxcnc else None
        if found is None and self._is_sure and not self._is_linuxcnc:
            following = self._fanuc_statement(text, block)
            if following is not None:
                return following
        if found is None:
            self._control.remarks.lost(block, "conditions and jumps are not evaluated")
            self._control.recorder.unknown()
            self._begin_condition()
            return block + 1
        name, keyword, rest = found[1].upper(), found[2].lower(), found[3]
        if keyword == "sub":
            return self._ends.get(name, len(self._text) - 1) + 1
        if keyword == "call":
            target = self._programs.get(name)
            if target is None:
                return self._outside(
                    block, f"the subprogram {name.lower()} is not in this file"
                )
            if self._is_conditional and self._flow.is_inside(target + 1):
                return self._outside(block, "a call of itself")
            given = [evaluate(each, self._variables) for each in BRACKETS.findall(rest)]
            zeros: dict[int | str, float] = dict.fromkeys(range(1, 31), 0.0)
            self._variables.enter(zeros | dict(enumerate(given, start=1)))
            return self._flow.call(block, target + 1)
        if keyword == "return" and self._open:
            return block + 1
        if keyword in {"endsub", "return"}:
            value = evaluate(rest, self._variables) if rest.strip() else 0.0
            self._variables.set("_value", value)
            following = self._leave()
            return block + 1 if following is None else following
        known = self._evaluated(name, keyword, rest, block) if self._is_sure else None
        return self._looped(name, keyword, rest, block) if known is None else known

    @property
    def _is_sure(self) -> bool:
        """True if it is known that the block is executed."""
        return not self._open and not self._is_conditional

    def _next_of(self, name: str, block: int, *keywords: str) -> int | None:
        """Next block with one of some keywords of an O word."""
        for place, keyword in self._keywords.get(name, ()):
            if place > block and keyword in keywords:
                return place
        return None

    def _evaluated(self, name: str, keyword: str, rest: str, block: int) -> int | None:
        """Next block by a condition or loop whose variables are known; None: not evaluated."""
        if keyword in {"if", "elseif", "else", "endif"}:
            return self._branched(name, keyword, rest, block)
        if keyword in {"break", "continue"} and name in self._begun:
            end = self._next_of(name, block, "endwhile", "while")
            if end is None:
                return None
            if keyword == "continue":
                return end
            del self._begun[name]
            return end + 1
        if keyword == "do":
            self._begun[name] = block
            return block + 1
        if keyword == "endwhile" and name in self._begun:
            return self._begun[name]
        if keyword == "while":
            return self._turned(name, rest, block)
        if keyword == "repeat":
            return self._counted(name, rest, block)
        return None

    def _branched(self, name: str, keyword: str, rest: str, block: int) -> int | None:
        """Take one branch of a condition."""
        if keyword == "if":
            self._branches.pop(name, None)
        elif name not in self._branches:
            return None
        if keyword == "endif":
            del self._branches[name]
            return block + 1
        if keyword != "if" and self._branches[name]:
            return self._next_of(name, block, "endif")
        value = 1.0 if keyword == "else" else evaluate(rest, self._variables)
        following = self._next_of(name, block, "elseif", "else", "endif")
        if isnan(value) or (keyword != "else" and following is None):
            self._branches.pop(name, None)
            if keyword == "elseif":
                self._control.remarks.lost(block, "conditions are not evaluated")
                self._begin_condition()
                self._open.append((name, "if"))
                return block + 1
            return None
        self._branches[name] = value != 0.0
        return block + 1 if value != 0.0 else following

    def _turned(self, name: str, rest: str, block: int) -> int | None:
        """Begin another turn of a loop, or leave it."""
        begun = self._begun.get(name)
        is_end = begun is not None and begun < block and self._is_do(name, begun)
        end = block if is_end else self._next_of(name, block, "endwhile")
        if end is None:
            return None
        value = evaluate(rest, self._variables)
        is_known = not isnan(value) and not self._flow.is_worn_out
        if begun is None and not is_known:
            return None
        if not is_known:
            # Its blocks have run some times; how often in truth is not known.
            del self._begun[name]
            self._outside(block, "a loop whose number of turns is not known")
            return end + 1
        if value == 0.0:
            self._begun.pop(name, None)
            return end + 1
        if is_end and begun is not None:
            return begun + 1
        self._begun[name] = block
        return block + 1

    def _is_do(self, name: str, block: int) -> bool:
        """True if a loop begins with DO and ends with its condition."""
        return (block, "do") in self._keywords.get(name, ())

    def _counted(self, name: str, rest: str, block: int) -> int | None:
        """Begin a repeat whose number follows from variables."""
        count, end = evaluate(rest, self._variables), self._next_of(name, block, "endrepeat")
        if isnan(count) or end is None:
            return None
        if count < 1.0:
            return end + 1
        self._repeats[name] = block
        self._times[block] = min(int(count), 10**9)
        return block + 1

    def _fanuc_statement(self, text: str, block: int) -> int | None:
        """Next block by a condition, loop or jump of Fanuc; None: not evaluated."""
        if found := FANUC_END.fullmatch(text):
            return self._begun.get(found[1])
        if found := FANUC_LOOP.fullmatch(text):
            end = self._loops.get(block)
            value = evaluate(found[1], self._variables)
            if end is None or isnan(value) or self._flow.is_worn_out:
                if self._begun.pop(found[2], None) is None or end is None:
                    return None
                self._outside(block, "a loop whose number of turns is not known")
                return end + 1
            if value == 0.0:
                self._begun.pop(found[2], None)
                return end + 1
            self._begun[found[2]] = block
            return block + 1
        if found := FANUC_THEN.fullmatch(text):
            value = evaluate(found[1], self._variables)
            if isnan(value):
                # Whether it is assigned is not known, but no jump: the rest is executed.
                return block + 1 if forget_assigned(found[2], self._variables) else None
            if value != 0.0:
                self._control.assign(BlockWords(assignments=[found[2]]))
            return block + 1
        found = FANUC_JUMP.fullmatch(text)
        if found is None:
            return None
        value = 1.0 if found[1] is None else evaluate(found[1], self._variables)
        if value == 0.0:
            return block + 1
        return None if isnan(value) or self._flow.is_worn_out else self._at(found[2], block)

    def _at(self, number: str, block: int) -> int | None:
        """Block of a number in the same program: the next one, or the first."""
        begins = [each for each in self._starts if each <= block]
        first = begins[-1] if begins else 0
        beyond = next((each for each in self._starts if each > block), len(self._text))
        found = [
            place
            for name, place in self._numbered
            if int(name) == int(number) and first <= place < beyond
        ]
        return next((place for place in found if place > block), found[0] if found else None)

    def _looped(self, name: str, keyword: str, rest: str, block: int) -> int:
        """Repeat a number of times, or execute what depends on a condition once."""
        if keyword == "repeat":
            count = COUNT.fullmatch(rest.strip())
            if count is not None:
                self._repeats[name] = block
                self._times[block] = min(int(count[1]), 10**9)
                return block + 1
        if keyword == "endrepeat" and name in self._repeats:
            start = self._repeats[name]
            return self._flow.repeat(block, start + 1, times=self._times[start] - 1)
        is_end = keyword in {"endif", "endwhile", "endrepeat"} or (name, "do") in self._open
        if is_end:
            self._open = [each for each in self._open if each[0] != name]
            if not self._open:
                self._end_condition()
        elif keyword in {"if", "while", "do", "repeat"}:
            if not self._open:
                self._control.remarks.lost(block, "conditions are not evaluated")
                self._begin_condition()
            self._open.append((name, keyword))
        return block + 1

    def _begin_condition(self) -> None:
        self._control.recorder.standing |= MoveFlag.CONDITIONAL.value
        self._before = self._control.modal()
        self._changed = set()

    def _end_condition(self) -> None:
        """Forget what the blocks of a condition have changed."""
        control = self._control
        control.recorder.standing &= ~MoveFlag.CONDITIONAL.value
        changed, self._before = self._changed, None
        if changed:
            control.recorder.unknown()
            control.forget_changed(changed)

    def _note_changes(self) -> None:
        assert self._before is not None
        now = self._control.modal()
        pairs = enumerate(zip(self._before, now, strict=True))
        self._changed |= {index for index, (one, other) in pairs if one != other}
