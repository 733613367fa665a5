"""Datum of a Klartext program: preset, shift, and whether coordinates are rotated or scaled."""

import re
from dataclasses import replace
from math import nan

from stepnc_model.nc.klartext_words import KlartextWords
from stepnc_model.nc.moves import MoveFlag
from stepnc_model.nc.recorder import MoveRecorder, frame_name

PARAMETER = re.compile(r"Q[LRS]?[0-9]")

SHIFT, MIRROR = "7", "8"
SCALES = {"11", "26"}
"""Numbers of cycles that move, mirror and scale the coordinates."""


class KlartextDatum:
    """Datum in force. Running state."""

    def __init__(self, recorder: MoveRecorder) -> None:
        self._recorder = recorder
        self._preset = "preset"
        self._shift, self._shifted_by = [0.0, 0.0, 0.0], 0

    def transform(self, is_on: bool) -> None:
        """Begin or end rotated, scaled, mirrored or tilted coordinates."""
        flag = MoveFlag.TRANSFORMED.value
        if is_on:
            self._recorder.standing |= flag
        else:
            self._recorder.standing &= ~flag
        self._recorder.at = [nan, nan, nan]

    def to_preset(self, number: float) -> None:
        """Take another preset (cycle 247), in which the position is not known yet."""
        self._preset = f"preset {number:g}"
        self._recorder.at = [nan, nan, nan]
        self._name_frame()

    def change(self, words: KlartextWords, number: str, *, scale: float) -> None:
        """Take a shift, mirror, rotation, scale or tilt by the cycle of this number.

        Parameters
        ----------
        words : KlartextWords
        number : str
            Number of the cycle.
        scale : float, mm
            Length of one unit of the program.
        """
        if words.cycle.endswith(".0"):
            return
        if number == SHIFT:
            self.shift_by(words, scale=scale, is_anew=False)
            return
        # ROT and SCL are no addresses: their number stands alone, or is a Q parameter.
        given = [*words.values.values(), *words.numbers]
        neutral = 1.0 if number in SCALES else 0.0
        is_macro = bool(words.macros) or any(PARAMETER.match(name) for name in words.names)
        is_on = is_macro or any(value != neutral for value in given)
        is_on = is_on or (number == MIRROR and bool(set("XYZ") & set(words.names)))
        self.transform(is_on)

    def shift_by(self, words: KlartextWords, *, scale: float, is_anew: bool) -> None:
        """Shift the coordinates; by a line of the datum table the distance is not known."""
        new = [0.0, 0.0, 0.0] if is_anew else list(self._shift)
        if "#" in words.strange or "TABLE" in words.names:
            new = [nan, nan, nan]
        for axis, letter in enumerate("XYZ"):
            if letter in words.values:
                new[axis] = scale * words.values[letter]
            elif f"I{letter}" in words.values:
                new[axis] += scale * words.values[f"I{letter}"]
            elif letter in words.macros or f"I{letter}" in words.macros:
                new[axis] = nan
        self.shift_to(new)

    def shift_to(self, new: list[float]) -> None:
        """Shift the coordinates to a distance from the preset, mm; NaN if not known."""
        at = self._recorder.at
        self._recorder.at = [a + o - s for a, o, s in zip(at, self._shift, new, strict=True)]
        self._shift, self._shifted_by = new, self._recorder.block
        self._name_frame()

    def _name_frame(self) -> None:
        name = frame_name(self._preset, self._shift, self._shifted_by)
        frame = self._recorder.frame(name)
        self._recorder.setting = replace(self._recorder.setting, frame=frame)
