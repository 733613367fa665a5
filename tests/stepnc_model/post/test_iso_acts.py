"""What G codes do."""

from stepnc_model.post.blocks import RateMode
from stepnc_model.post.words import CANNED, COMMON, MOTIONS, PER_TIME, GCodeAction
from stepnc_model.toolpath.path import ArcPlane, CycleKind


def test_every_cycle_but_the_tap_has_a_code() -> None:
    cycles = {act for act in CANNED.values() if isinstance(act, CycleKind)}
    assert cycles == set(CycleKind) - {CycleKind.TAP}


def test_every_plane_and_mode_has_a_code() -> None:
    assert set(ArcPlane) <= set(COMMON.values())
    assert set(RateMode) == set(PER_TIME.values())


def test_settings_are_no_motions() -> None:
    assert not MOTIONS & {
        *ArcPlane,
        *RateMode,
        GCodeAction.NOTHING,
        GCodeAction.DWELL,
        GCodeAction.CANCEL,
    }


def test_shared_codes_mean_one_thing() -> None:
    assert not set(COMMON) & set(CANNED)
