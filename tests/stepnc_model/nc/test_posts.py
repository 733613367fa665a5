"""Programs in the manner of known post-processors, as a shop has them."""

import numpy as np
import pytest

from stepnc_model.nc.advice import BlockAdvice
from stepnc_model.nc.moves import MoveFlag, MoveKind
from stepnc_model.nc.program import read_program
from stepnc_model.nc.rewrite import rewrite
from stepnc_model.post.dialect import Dialect

FREECAD = (
    b"(Exported by FreeCAD)\n"
    b"(Post Processor: linuxcnc_post)\n"
    b"(begin preamble)\n"
    b"G17 G54 G40 G49 G80 G90\n"
    b"G21\n"
    b"(begin operation: Fixture)\n"
    b"G54\n"
    b"(finish operation: Fixture)\n"
    b"(begin toolchange: TC: Endmill)\n"
    b"( TC: Endmill )\n"
    b"M5\n"
    b"M6 T1\n"
    b"G43 H1\n"
    b"M3 S2000\n"
    b"(begin operation: Profile)\n"
    b"G0 Z5.000\n"
    b"G0 X-3.000 Y0.000\n"
    b"G1 X-3.000 Y0.000 Z-1.000 F120.000\n"
    b"G1 X-3.000 Y20.000 F480.000\n"
    b"G2 X0.000 Y23.000 Z-1.000 I3.000 J0.000 K0.000 F480.000\n"
    b"G1 X20.000 Y23.000\n"
    b"G2 X23.000 Y20.000 I0.000 J-3.000 K0.000\n"
    b"G0 Z5.000\n"
    b"M5\n"
    b"G17 G54 G90 G80 G40\n"
    b"M2\n"
)
FUSION_HAAS = (
    b"%\n"
    b"O01001 (BRACKET)\n"
    b"(USING HIGH FEED G1 F5000. INSTEAD OF G0.)\n"
    b"(T1 D=10. CR=0. - ZMIN=-5. - FLAT END MILL)\n"
    b"N10 G90 G94 G17\n"
    b"N15 G21\n"
    b"N20 G53 G0 Z0.\n"
    b"(2D POCKET)\n"
    b"N25 T1 M6\n"
    b"N30 S5000 M3\n"
    b"N35 G17 G90 G94\n"
    b"N40 G54\n"
    b"N45 M8\n"
    b"N50 G0 X10.5 Y20.25\n"
    b"N55 G43 Z15. H1\n"
    b"N60 Z5.\n"
    b"N65 G1 Z1. F333.\n"
    b"N70 G3 X9.5 Y19.25 Z-1. I0. J-1. F1000.\n"
    b"N75 X10.5 Y18.25 I1. J0.\n"
    b"N80 G1 X30. F1000.\n"
    b"N85 G0 Z15.\n"
    b"N90 M9\n"
    b"N95 M5\n"
    b"N100 G53 G0 Z0.\n"
    b"N105 X0. Y0.\n"
    b"N110 G53 G0 Y0.\n"
    b"N115 M30\n"
    b"%\n"
)
FUSION_FANUC = (
    b"%\n"
    b"O1002\n"
    b"N10 G90 G94 G17 G49 G40 G80\n"
    b"N15 G21\n"
    b"N20 G28 G91 Z0.\n"
    b"N25 G90\n"
    b"N30 T2 M6\n"
    b"N35 S1200 M3\n"
    b"N40 G54\n"
    b"N45 M8\n"
    b"N50 G0 X5. Y5.\n"
    b"N55 G43 Z15. H2\n"
    b"N60 G0 Z5.\n"
    b"N65 G98 G83 X5. Y5. Z-20. R2. Q3. F150.\n"
    b"N70 X25.\n"
    b"N75 Y25.\n"
    b"N80 G80\n"
    b"N85 Z15.\n"
    b"N90 M5\n"
    b"N95 G28 G91 Z0.\n"
    b"N100 M30\n"
    b"%\n"
)
SINUMERIK = (
    b"; %_N_PART_MPF\n"
    b"N10 G90 G94 G17\n"
    b"N20 G71\n"
    b'N30 T="MILL_10" D1\n'
    b"N40 M6\n"
    b"N50 S3000 M3\n"
    b"N60 G54\n"
    b"N70 G0 X0 Y0\n"
    b"N80 Z50\n"
    b"N90 Z2\n"
    b"N100 G1 Z-2 F200\n"
    b"N110 G41 G1 X10 Y0 F500\n"
    b"N120 Y30\n"
    b"N130 G40 X0\n"
    b"N140 G2 X10 Y40 I=AC(10) J=AC(30)\n"
    b"N150 TRANS X50\n"
    b"N160 G0 X0 Y0 Z10\n"
    b"N170 G1 X10 F300\n"
    b"N180 TRANS\n"
    b"N190 MCALL CYCLE83(50,0,2,-20,,-5,,2,0,0,1,1)\n"
    b"N200 X10 Y10\n"
    b"N210 X20\n"
    b"N220 MCALL\n"
    b"N230 CYCLE800()\n"
    b"N240 R1=5\n"
    b"N250 G1 X=R1 F200\n"
    b"N260 M30\n"
)
HEIDENHAIN = (
    b"0  BEGIN PGM PART MM\n"
    b"1  BLK FORM 0.1 Z X+0 Y+0 Z-20\n"
    b"2  BLK FORM 0.2  X+100  Y+100  Z+0\n"
    b"3  TOOL CALL 5 Z S3200 F750\n"
    b"4  L  Z+100 R0 FMAX M3\n"
    b"5  L  X+10 Y+10 R0 FMAX\n"
    b"6  L  Z+2 FMAX\n"
    b"7  L  Z-5 F150\n"
    b"8  L  X+90 RL F500\n"
    b"9  RND R5\n"
    b"10 L  Y+90\n"
    b"11 L  X+10\n"
    b"12 DEP LCT X-10 Y+10 R5 F1000\n"
    b"13 L Z+50 R0 FMAX\n"
    b"14 CYCL DEF 203 UNIVERSAL DRILLING ~\n"
    b"    Q200=+2    ;SET-UP CLEARANCE ~\n"
    b"    Q201=-20   ;DEPTH ~\n"
    b"    Q206=+150  ;FEED RATE FOR PLNGN ~\n"
    b"    Q202=+5    ;PLUNGING DEPTH ~\n"
    b"    Q203=+0    ;SURFACE COORDINATE ~\n"
    b"    Q204=+50   ;2ND SET-UP CLEARANCE\n"
    b"15 L X+20 Y+20 R0 FMAX M99\n"
    b"16 CALL LBL 7\n"
    b"17 L X+0 Y+0 Z+0 F500\n"
    b"18 M30\n"
    b"19 LBL 7\n"
    b"20 L IX+10 F300\n"
    b"21 LBL 0\n"
    b"22 END PGM PART MM\n"
)


def test_freecad_is_understood_from_end_to_end() -> None:
    program = read_program(FREECAD)
    moves = program.moves
    assert (program.dialect, program.findings) == (Dialect.LINUXCNC, ())
    fed = moves.kind != MoveKind.RAPID
    assert moves.feed[fed] * 60.0 == pytest.approx([120.0, 480.0, 480.0, 480.0, 480.0])
    assert moves.is_splittable[fed].all()
    result = rewrite(
        program, [BlockAdvice(block=19, ends=(0.5, 1.0), feeds=(5.0, 6.0), reason="force")]
    )
    assert result.data == FREECAD.replace(
        b"G2 X0.000 Y23.000 Z-1.000 I3.000 J0.000 K0.000 F480.000\nG1 X20.000 Y23.000\n",
        b"G2 X-2.1213 Y22.1213 Z-1.000 I3.000 J0.000 K0.000 F300\n"
        b"G2 X0.000 Y23.000 Z-1.000 I2.1213 J-2.1213 K0.000 F360\n"
        b"G1 X20.000 Y23.000 F480.000\n",
    )


def test_fusion_for_a_haas_retracts_in_machine_coordinates() -> None:
    program = read_program(FUSION_HAAS)
    moves = program.moves
    assert (program.dialect, program.findings) == (Dialect.HAAS, ())
    in_machine = (moves.flags & int(MoveFlag.MACHINE)) != 0
    lines = [program.text.line(int(block)) for block in moves.block[in_machine]]
    assert lines == [7, 24, 26]
    assert moves.turn[moves.kind == MoveKind.ARC] == pytest.approx([0.5 * np.pi] * 2)


def test_fusion_for_a_fanuc_drills_every_hole_at_one_feed() -> None:
    program = read_program(FUSION_FANUC)
    moves = program.moves
    assert (program.dialect, program.findings) == (Dialect.FANUC, ())
    drilled = moves.kind == MoveKind.LINE
    assert drilled.sum() == 3 * 8
    assert set(moves.feed[drilled].tolist()) == {2.5}
    assert moves.end[-2].tolist()[2] == 15.0
    result = rewrite(program, [BlockAdvice(block=13, ends=(1.0,), feeds=(2.0,))])
    assert result.data == FUSION_FANUC.replace(b"F150.", b"F120.").replace(
        b"N70 X25.", b"N70 X25. F150."
    )


def test_a_sinumerik_program_shifts_compensates_and_calls_its_cycle() -> None:
    program = read_program(SINUMERIK)
    moves = program.moves
    assert program.dialect is Dialect.SINUMERIK
    assert moves.frames == ("G54", "G54 shifted by X 50")
    compensated = (moves.flags & int(MoveFlag.COMPENSATED)) != 0
    lines = {program.text.line(int(block)) for block in moves.block[compensated]}
    assert lines >= {12, 13, 14}
    assert not (moves.is_splittable & compensated).any()
    drilled = ((moves.flags & int(MoveFlag.CYCLE)) != 0) & (moves.kind == MoveKind.LINE)
    assert moves.end[drilled][:, 2].min() == -20.0


def test_a_klartext_program_rounds_drills_and_calls_its_label() -> None:
    program = read_program(HEIDENHAIN)
    moves = program.moves
    assert program.dialect is Dialect.HEIDENHAIN
    assert [each.line for each in program.findings] == [13]
    rounded = (moves.flags & int(MoveFlag.ROUNDED)) != 0
    lines = [program.text.line(int(block)) for block in moves.block[rounded]]
    assert lines == [9, 11]
    drilled = ((moves.flags & int(MoveFlag.CYCLE)) != 0) & (moves.kind == MoveKind.LINE)
    assert moves.end[drilled][:, 2].tolist() == [-3.0, -8.0, -13.0, -18.0, -20.0]
    assert set((moves.feed[drilled] * 60.0).round(6).tolist()) == {150.0}
    called = moves.call > 0
    assert moves.end[called].tolist() == [[30.0, 20.0, 50.0]]
