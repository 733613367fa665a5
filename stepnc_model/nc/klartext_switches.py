"""What blocks of Klartext do between moves, and what is unread in them.

After Heidenhain, "iTNC 530 User's Manual, Conversational Programming".
"""

from math import isnan

from stepnc_model.nc.klartext_words import KlartextWords
from stepnc_model.nc.recorder import MoveRecorder
from stepnc_model.nc.remarks import Remarks
from stepnc_model.nc.switches import COMMON, SwitchRecorder
from stepnc_model.post.dialect import Dialect
from stepnc_model.post.words import LARGEST

PATHS = frozenset({"L", "C", "CR", "CP"})
PATH_NAMES = PATHS | {"R0", "RL", "RR", "FMAX", "F", "MAX", "DR+", "DR-", "M"}
"""Names in the blocks of paths."""

PATH_VALUES = frozenset({*"XYZABCUVWFR", "IX", "IY", "IZ", "IPA", "FU"})
"""Addresses in the blocks of paths."""

NAME_MARKS = frozenset("_-.$#&%")
"""Marks in the name of a program."""

PARAMETERS = frozenset(
    f"Q{number}" for number in (200, 201, 202, 203, 204, 206, 211, 239, 256, 257, 258, 259)
)
"""Parameters of drilling cycles that are read."""

FUNCTIONS = (COMMON - {60, 70}) | {890, 990, 1360, 1370}
"""M codes that are read: switches, stops, calls of cycles, and the reference of F."""


class KlartextSwitches(SwitchRecorder):
    """Recorder of switches in Klartext. Running state."""

    def __init__(self, recorder: MoveRecorder, remarks: Remarks) -> None:
        super().__init__(recorder, remarks, Dialect.HEIDENHAIN)

    def begun(self, words: KlartextWords) -> None:
        """Record the comments of a block, and note what is no word."""
        for comment in words.comments:
            self.comment(comment)
        is_name = words.names[1:2] == ["PGM"] and words.names[0] in {"BEGIN", "END"}
        strange = [each for each in words.strange if not (is_name and each in NAME_MARKS)]
        if strange:
            self.unread(f"'{strange[0]}' is not known")

    def ended(self, words: KlartextWords) -> None:
        """Record switches and stops of a block, and note what no part of it has used."""
        self.before_move(words.functions)
        self.after_move([0] if words.names[:1] == ["STOP"] else words.functions)
        for code in words.functions:
            if code not in FUNCTIONS:
                self.unread(f"M{code / 10:g} is not known")
        if any(abs(each) >= LARGEST for each in words.numbers):
            self.unread(f"a number of {LARGEST:g} or more")
        if words.names[:2] == ["CYCL", "DEF"]:
            for name, value in words.assigned.items():
                if isnan(value) or (value != 0.0 and name not in PARAMETERS):
                    self.unread(f"{name}={value:g} is not read")
        if words.names[:1] == ["CC"] and (len(words.names) > 1 or len(words.axes) == 1):
            self.unread("CC needs two of X, Y and Z, and nothing else")
        if PATHS & set(words.names[:1]):
            left = (set(words.names) - PATH_NAMES) | (
                {*words.values, *words.macros} - PATH_VALUES
            )
            if left:
                self.unread(f"{', '.join(sorted(left))}: not used by this block")
