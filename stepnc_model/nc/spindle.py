"""Blocks that bring the spindle to its speed, from the modal setting of NC code."""

from stepnc_model.nc.moves import ModalSetting
from stepnc_model.post.blocks import SpindleDirection, SpindleOff, SpindleOn, SurfaceSpeed

SpindleBlock = SpindleOff | SpindleOn | SurfaceSpeed


def spindle_block(setting: ModalSetting) -> SpindleBlock | None:
    """Block that brings the spindle to its speed in a setting; None if it is not known."""
    if setting.spindle is None:
        return None
    if setting.spindle == 0.0:
        return SpindleOff()
    is_clockwise = setting.spindle > 0.0
    sense = SpindleDirection.CLOCKWISE if is_clockwise else SpindleDirection.COUNTERCLOCKWISE
    if setting.surface is not None:
        return SurfaceSpeed(speed=setting.surface, limit=setting.limit, sense=sense)
    return SpindleOn(speed=abs(setting.spindle), sense=sense)
