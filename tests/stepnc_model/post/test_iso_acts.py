"""What G codes do."""

from stepnc_model.post.iso_acts import CANNED, COMMON, KINDS, MODES, MOTIONS, PLANES, Act
from stepnc_model.toolpath.path import CycleKind, Plane


def test_every_cycle_but_the_tap_has_an_act() -> None:
    assert set(KINDS.values()) == set(CycleKind) - {CycleKind.TAP}


def test_every_plane_has_an_act() -> None:
    assert set(PLANES.values()) == set(Plane)


def test_settings_are_no_motions() -> None:
    assert not MOTIONS & {*PLANES, *MODES, Act.NOTHING, Act.DWELL, Act.CANCEL}


def test_shared_codes_mean_one_thing() -> None:
    assert not set(COMMON) & set(CANNED)
