"""The table of worked cases beside the project, evaluated in place."""

import json
from collections.abc import Callable, Mapping
from math import pi, sqrt
from pathlib import Path

import pytest

from simulator.physics import cutting as power
from simulator.physics import engagement, kinematics, milling, surface, tool_life, turning
from simulator.spec import Kienzle, LinearEdge, Taylor
from stepnc_model import units
from tests.oracles import cutting as oracle
from tests.oracles import motion as moves

TABLE = Path(__file__).parents[2].parent / "shared" / "data" / "worked_cases.json"
Figures = Mapping[str, float]
NOT_PHYSICS_OF_THE_CUT = {
    "F01_merchant": "shear-plane theory is not implemented: Kienzle is measured, not derived",
    "K06_screw": "the feed drives belong to the virtual machine",
    "K07_seed_axis": "the feed drives belong to the virtual machine",
    "K08_seed_spindle": "the spindle's inertia belongs to the virtual machine",
}


def turning_speed(given: Figures) -> Figures:
    speed = kinematics.cutting_speed(given["d"], units.rev_s_from_rpm(given["n"]))
    return {"vc": units.m_min_from_speed(speed)}


def turning_feed(given: Figures) -> Figures:
    feed, speed = units.speed_from_mm_min(given["l"]), units.rev_s_from_rpm(given["n"])
    return {"f": kinematics.feed_per_tooth(feed, speed)}


def turning_time(given: Figures) -> Figures:
    feed = kinematics.feed(given["f"], units.rev_s_from_rpm(given["n"]))
    seconds = moves.machining_time(given["L"], feed)
    return {"t": seconds / 60.0, "t_s": seconds}


def peak_to_valley(given: Figures) -> Figures:
    roughness = surface.corner_coefficient(given["r"]) * given["f"] ** 2
    return {"Rt": units.um_from_mm(oracle.RT_PER_RA * roughness)}


def arithmetic(given: Figures) -> Figures:
    coefficient = surface.corner_coefficient(given["r"])
    return {
        "Ra": units.um_from_mm(coefficient * given["f"] ** 2),
        "f_for_Ra1p6": sqrt(1.6e-3 / coefficient),
    }


def milling_speed(given: Figures) -> Figures:
    speed = kinematics.cutting_speed(given["D"], units.rev_s_from_rpm(given["n"]))
    return {"vc": units.m_min_from_speed(speed)}


def milling_feed_per_tooth(given: Figures) -> Figures:
    feed, speed = units.speed_from_mm_min(given["vf"]), units.rev_s_from_rpm(given["n"])
    return {"fz": kinematics.feed_per_tooth(feed, speed, teeth=int(given["z"]))}


def milling_feed(given: Figures) -> Figures:
    speed = units.rev_s_from_rpm(given["n"])
    feed = kinematics.feed(given["fz"], speed, teeth=int(given["z"]))
    return {"vf": units.mm_min_from_speed(feed)}


def face_milling_time(given: Figures) -> Figures:
    feed = units.speed_from_mm_min(milling_feed(given)["vf"])
    width = 0.6 * given["D"]
    seconds = moves.machining_time(
        given["L"],
        feed,
        approach=engagement.centred_approach(given["D"], width),
        overrun=oracle.centred_overrun(given["D"], width),
    )
    return {"vf": units.mm_min_from_speed(feed), "t": seconds / 60.0, "t_s": seconds}


def peripheral_milling(given: Figures) -> Figures:
    speed = kinematics.spindle_speed(given["D"], units.speed_from_m_min(given["v"]))
    feed = kinematics.feed(given["fz"], speed, teeth=int(given["z"]))
    approach = given["approach"] + engagement.one_sided_approach(given["D"], given["d"])
    seconds = moves.machining_time(given["L"], feed, approach=approach, overrun=given["over"])
    rate = kinematics.milling_removal_rate(
        feed, axial_depth=given["w"], radial_width=given["d"]
    )
    return {"t": seconds / 60.0, "MRR": rate * 60.0}


def taylor(given: Figures) -> Figures:
    pair = Taylor(exponent=given["n"], constant=units.speed_from_m_min(given["C"]))
    speed = units.speed_from_m_min(100.0)
    slower = tool_life.tool_life(pair, given["speed_factor"] * speed)
    return {"life_increase": 100.0 * (slower / tool_life.tool_life(pair, speed) - 1.0)}


def turning_force(given: Figures) -> Figures:
    cut = turning.TurningCut(
        feed_per_revolution=given["f"],
        depth=given["ap"],
        cutting_edge_angle=units.rad_from_deg(given["kappa"]),
    )
    force = turning.cutting_force(Kienzle(k_c11=given["kc11"], m_c=given["mc"]), cut)
    watts = power.cutting_power(force, units.speed_from_m_min(given["vc"]))
    return {"Fc": force, "Pc": units.kw_from_watts(watts)}


def slot_with_edge_term(given: Figures) -> Figures:
    cut = milling.MillingCut(
        feed_per_tooth=given["c"],
        teeth=int(given["N"]),
        axial_depth=given["a"],
        engagement=engagement.full_immersion(),
    )
    edge = LinearEdge(k_tc=given["Ktc"], k_te=given["Kte"])
    speed = units.rev_s_from_rpm(given["n"])
    force = oracle.edge_mean_force(edge, cut)
    watts = power.cutting_power(force, kinematics.cutting_speed(given["d"], speed))
    return {"T": units.nm_from_nmm(oracle.power_torque(watts, speed)), "P": watts}


def trapezoid(given: Figures) -> Figures:
    seconds = moves.move_time(
        1000.0 * given["L"],
        speed=units.speed_from_m_s(given["v"]),
        acceleration=1000.0 * given["a"],
    )
    return {"t": seconds}


def validation_cut(given: Figures) -> Figures:
    feed, speed = units.speed_from_mm_min(given["vf"]), units.rev_s_from_rpm(given["n"])
    teeth = int(given["z"])
    cut = milling.MillingCut(
        feed_per_tooth=kinematics.feed_per_tooth(feed, speed, teeth=teeth),
        teeth=teeth,
        axial_depth=given["ap"],
        engagement=engagement.full_immersion(),
    )
    k_c = milling.mean_specific_force(Kienzle(k_c11=given["kc11"], m_c=given["mc"]), cut)
    rate = kinematics.milling_removal_rate(
        feed, axial_depth=given["ap"], radial_width=given["d"]
    )
    return {
        "MRR": rate * 60.0,
        "Pc": oracle.removal_power(k_c, rate),
        "t_pass": moves.machining_time(101.6, feed),  # four inches
    }


def paper_optimum(given: Figures) -> Figures:
    speed = units.speed_from_m_min(given["Vc"])
    force = 1000.0 * units.watts_from_kw(given["Nm"]) * given["eta"] / speed
    teeth = int(given["z"])
    unit_cut = milling.MillingCut(
        feed_per_tooth=1.0,
        teeth=teeth,
        axial_depth=given["a"],
        engagement=engagement.full_immersion(),
    )
    f_z = force / milling.mean_force(Kienzle(k_c11=given["ks"], m_c=0.0), unit_cut)
    feed = kinematics.feed(f_z, kinematics.spindle_speed(given["d"], speed), teeth=teeth)
    return {"Fmt": force, "fz": f_z, "vf": units.mm_min_from_speed(feed)}


def mean_chip(given: Figures) -> Figures:
    arc = engagement.unidirectional(given["ae"], given["D"])
    h_m = engagement.mean_chip_thickness(
        given["fz"], arc, cutting_edge_angle=units.rad_from_deg(given["kappa"])
    )
    return {"we": arc.contact_angle * 180.0 / pi, "hm": h_m}


def block_time(given: Figures) -> Figures:
    seconds = 60.0 / given["slope"]
    speed = moves.speed_of_blocks(25.4e-3, seconds)
    return {
        "t_block": 1000.0 * seconds,
        "vmax_at_0.001in": units.mm_min_from_speed(speed) / 25.4,
    }


def step_nc_units(given: Figures) -> Figures:
    return {
        "F_mps": units.m_s_from_speed(units.speed_from_mm_min(given["F"])),
        "S_rps": units.rev_s_from_rpm(given["S"]),
        "F_G": units.mm_min_from_speed(units.speed_from_m_s(given["feed_stepnc"])),
        "S_G": units.rpm_from_rev_s(abs(given["spin_stepnc"])),
    }


SOLVERS: dict[str, Callable[[Figures], Figures]] = {
    "T01_vc": turning_speed,
    "T02_feed": turning_feed,
    "T03_time": turning_time,
    "R01_Rt": peak_to_valley,
    "R03_Ra_exact": arithmetic,
    "M01_vc": milling_speed,
    "M02_fz": milling_feed_per_tooth,
    "M03_vf": milling_feed,
    "M04_time": face_milling_time,
    "M14_periph": peripheral_milling,
    "M15_hm": mean_chip,
    "L02_taylor": taylor,
    "F02_kienzle_turn": turning_force,
    "P10_slot_edge": slot_with_edge_term,
    "P11_seed003_c1": validation_cut,
    "K01_trap": trapezoid,
    "K02_trap": trapezoid,
    "K03_trap": trapezoid,
    "O_ridwan_full_z4": paper_optimum,
    "O_ridwan_full_z1": paper_optimum,
    "C01_block": block_time,
    "C03_units": step_nc_units,
}


def figures(case: Mapping[str, Mapping[str, Mapping[str, float]]], key: str) -> Figures:
    return {name: entry["value"] for name, entry in case[key].items()}


@pytest.mark.skipif(not TABLE.exists(), reason=f"no {TABLE.name} beside the project")
@pytest.mark.parametrize("name", sorted(SOLVERS))
def test_worked_case(name: str) -> None:
    case = next(c for c in json.loads(TABLE.read_text(encoding="utf-8")) if c["id"] == name)
    found = SOLVERS[name](figures(case, "inputs"))
    for quantity, value in figures(case, "expected").items():
        assert found[quantity] == pytest.approx(value, rel=case["tolerance_rel"]), quantity


@pytest.mark.skipif(not TABLE.exists(), reason=f"no {TABLE.name} beside the project")
def test_every_worked_case_is_evaluated_or_excused() -> None:
    names = {case["id"] for case in json.loads(TABLE.read_text(encoding="utf-8"))}
    assert names == set(SOLVERS) | set(NOT_PHYSICS_OF_THE_CUT)
