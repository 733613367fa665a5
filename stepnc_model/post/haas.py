"""NC code for Haas controls, mill and lathe.

After Haas, "Mill Operator's Manual" and "Lathe Operator's Manual" (Next Generation Control):
much as Fanuc, but P of a dwell is in s when it has a point and in ms when not, M88 and M89
switch coolant through the spindle, G84 starts the spindle itself (G74 on a mill and G184 on a
lathe for left-hand threads), and a mill has no thread cutting. How far above the last depth a
peck begins is setting 22.
"""

from stepnc_model.post.blocks import CoolantKind, Machine, Sense
from stepnc_model.post.fanuc import Manner
from stepnc_model.post.words import pointed

HAAS = Manner(
    head="O00001",
    seconds=lambda value: f"P{pointed(value, 3)}",
    seconds_of=lambda value, pointless: value / 1000.0 if pointless else value,
    coolant={CoolantKind.FLOOD: "M8", CoolantKind.MIST: "M7", CoolantKind.THROUGH: "M88"},
    coolant_ends=("M9", "M89"),
    threads={Machine.LATHE: "G32"},
    taps={
        (Machine.MILL, Sense.CLOCKWISE): "G84",
        (Machine.MILL, Sense.COUNTERCLOCKWISE): "G74",
        (Machine.LATHE, Sense.CLOCKWISE): "G84",
        (Machine.LATHE, Sense.COUNTERCLOCKWISE): "G184",
    },
    tap_speed="",
    retract=frozenset({Machine.MILL, Machine.LATHE}),
)
