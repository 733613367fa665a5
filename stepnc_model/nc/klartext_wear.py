"""Wear of a tool that a tool call of Heidenhain Klartext states (DR, DL).

``TOOL CALL 5 Z S3000 DL+0.1 DR+0.05`` tells the control that the tool is longer and wider than
in the tool table. It goes that much farther from a compensated contour, and the tip of the tool
of the table stands that much higher than the program says.
"""

from dataclasses import replace
from math import nan

from stepnc_model.nc.klartext_words import KlartextWords
from stepnc_model.nc.moves import ModalSetting


def with_wear(setting: ModalSetting, words: KlartextWords, *, scale: float) -> ModalSetting:
    """Setting with the wear that a tool call states.

    Parameters
    ----------
    setting : ModalSetting
        Setting before the call.
    words : KlartextWords
        Words of the call. One of a tool ends the wear before; one of a speed alone keeps it.
    scale : float, mm
        Length of one unit of the program.
    """
    is_tool = bool(words.numbers or words.texts)

    def stated(name: str, before: float) -> float:
        if name in words.macros:
            return nan
        number = words.values.get(name)
        if number is None:
            return 0.0 if is_tool else before
        return scale * number

    return replace(
        setting,
        radius_wear=stated("DR", setting.radius_wear),
        length_wear=stated("DL", setting.length_wear),
    )
