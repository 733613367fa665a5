"""Q parameters of Klartext: their values in words, formulas and jumps, as far as known."""

import re
from collections.abc import Mapping
from math import isnan, nan

from stepnc_model.nc.klartext_words import KlartextWords
from stepnc_model.nc.parameters import KLARTEXT, Parameters
from stepnc_model.post.words import LARGEST

JUMP = re.compile(r"IF\s+(.+?)\s+GOTO\s+LBL\s*([0-9]+|\"[^\"]*\")", re.IGNORECASE | re.DOTALL)

CYCLE_FEED = "Q206"
"""Feed of a cycle: one from a parameter is left alone, and so are its moves."""


class KlartextParameters:
    """Q parameters of one program. Running state."""

    def __init__(self) -> None:
        self._parameters = Parameters(KLARTEXT)

    def take(self, words: KlartextWords, *, is_sure: bool) -> None:
        """Compute words from parameters as far as they are known, then set parameters.

        Parameters
        ----------
        words : KlartextWords
            Words of a block, whose computed ones become numbers.
        is_sure : bool
            Whether it is known that the block is executed.
        """
        for name, text in list(words.macros.items()):
            value = self._parameters.evaluate(text)
            if not isnan(value) and abs(value) <= LARGEST:
                del words.macros[name]
                words.evaluated.add(name)
                words.values[name] = value
        for name, text in words.formulas.items():
            value = self._parameters.evaluate(text)
            if name != CYCLE_FEED:
                words.assigned[name] = value
            self._parameters.set(name, value if is_sure else nan)

    def jumped(self, text: str, block: int, labels: Mapping[str, int]) -> int | None:
        """Block after a conditional jump; None: it depends on what is not known.

        Parameters
        ----------
        text : str
            Text of the block.
        block : int
        labels : mapping
            Blocks of the labels.
        """
        found = JUMP.search(text)
        value = nan if found is None else self._parameters.evaluate(found[1])
        if found is None or isnan(value):
            return None
        return labels.get(found[2].upper()) if value else block + 1

    def forget(self) -> None:
        """Forget all values, as after a program that is not here."""
        self._parameters.forget()
