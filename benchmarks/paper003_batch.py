"""The ten parts of Lechevalier et al. (2018), Fig. 11, beside runs of the pocket.

Fig. 11 prints feed (m/s), spindle speed (rev/s, negative clockwise) and depth (mm) of ten parts
with their machining times. The pocket has no printed dimension: its side, one number, is fitted
to the ten times. Then the lines of time over 1/feed, also with the spindle speed; the columns
of Fig. 11 beside those of batches in a shop, also of the two slots of §4.3; the slots
themselves; and the interpolated cycles beside direct runs with settings drawn as in §4.2.
"""

import argparse
import csv
from collections.abc import Sequence
from dataclasses import dataclass
from math import pi
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import TextIO

import numpy as np

from extras.factory.cycles import PartCycles
from extras.factory.model.cycle import PartCycle, drawn_energies
from extras.factory.model.interpolation import SettingRange, SettingsDesign
from extras.factory.parts_file import COLUMNS
from extras.factory.requests import FactoryRequest
from extras.factory.run import run_factory
from service.programs.machine_choice import material_for
from simulator.library import load_machine
from simulator.motion.segments import Floats
from stepnc_model.editing.cut_settings import CutSettings
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from stepnc_model.units import seconds_from_ms, speed_from_m_s

EXAMPLES = Path(__file__).parents[1] / "examples"
PRINT = EXAMPLES / "paper003_fig11.csv"
POCKET = EXAMPLES / "parts" / "paper003_pocket.stpnc"
SIDE = "92.2"
"""mm, as the sample part has it"""
SIDES = (90.0, 91.0, 92.0, 92.1, 92.2, 92.3, 92.4, 93.0, 94.0)
"""mm"""
LOW, HIGH = (30.0, 75.4 / (2.0 * pi), 2.5), (90.0, 226.2 / (2.0 * pi), 3.5)
"""mm/s, rev/s and mm of §4.2"""
RUNS = 200
NAMES = tuple(name for name in COLUMNS if name != "material")
"""Columns of Fig. 11, in the order of its print."""
MILL = "MILLING_MACHINE_1"


@dataclass(frozen=True, slots=True, kw_only=True)
class PrintedPart:
    """One row of Fig. 11."""

    id: str
    settings: CutSettings
    machining: float
    """s"""


def printed() -> tuple[PrintedPart, ...]:
    """The rows of Fig. 11."""
    with PRINT.open(encoding="ascii") as file:
        return tuple(
            PrintedPart(
                id=row["id"],
                settings=CutSettings(
                    feed=speed_from_m_s(float(row["feed_m_s"])),
                    spindle_speed=float(row["spindle_rev_s"]),
                    depth=float(row["depth_mm"]),
                ),
                machining=seconds_from_ms(float(row["machining_ms"])),
            )
            for row in csv.DictReader(file)
        )


def pocket(side: float) -> Program:
    """The sample part with another side of its pocket, mm."""
    text = POCKET.read_text(encoding="ascii")
    data = text.replace(f"({SIDE},", f"({side:.1f},").encode("ascii")
    return Program(Part21File.from_bytes(data, name=POCKET.name), name=POCKET.name)


MACHINE = load_machine("paper003")


def times(cycles: PartCycles, program: Program, parts: tuple[PrintedPart, ...]) -> Floats:
    """Machining times of the parts on the paper's machine, (N,), s."""
    match = material_for("", program)
    found = [cycles.cycle(program, MACHINE, match, part.settings).time for part in parts]
    return np.array(found)


@dataclass(frozen=True, slots=True, kw_only=True)
class FittedLine:
    """Least squares line of times."""

    coefficients: Floats
    errors: Floats
    """Standard errors of the coefficients."""
    rms: float
    """Root mean square of the residuals, s."""


def line(columns: list[Floats], seconds: Floats) -> FittedLine:
    """Least squares of times over an intercept and some columns."""
    matrix = np.stack([np.ones(len(seconds)), *columns], axis=1)
    solved = np.linalg.lstsq(matrix, seconds)[0].astype(np.float64)
    left = seconds - matrix @ solved
    variance = float(left @ left) / (len(seconds) - matrix.shape[1])
    errors = np.sqrt(variance * np.diag(np.linalg.inv(matrix.T @ matrix)))
    return FittedLine(coefficients=solved, errors=errors, rms=float(np.sqrt(np.mean(left**2))))


def slowness(parts: tuple[PrintedPart, ...]) -> Floats:
    """1/feed of the parts, (N,), s/mm."""
    return np.array([1.0 / (part.settings.feed or 1.0) for part in parts])


def speeds(parts: tuple[PrintedPart, ...]) -> Floats:
    """Spindle speeds of the parts, (N,), rev/s."""
    return np.array([abs(part.settings.spindle_speed or 0.0) for part in parts])


def main(arguments: list[str] | None = None) -> None:
    """Print the fit of the side, the ten parts, the lines, the slots and the interpolation."""
    argparse.ArgumentParser(description=__doc__).parse_args(arguments)
    parts, cycles = printed(), PartCycles()
    told = np.array([part.machining for part in parts])
    print("side mm  mean difference s  rms s")
    for side in SIDES:
        off = times(cycles, pocket(side), parts) - told
        print(f"{side:7.1f}{off.mean():19.3f}{np.sqrt(np.mean(off**2)):7.3f}")
    ours = times(cycles, Program.load(POCKET), parts)
    _print_parts(parts, told, ours)
    _print_lines(parts, told, ours)
    _print_columns()
    _print_slots(cycles)
    _print_interpolation(cycles)


def _print_parts(parts: tuple[PrintedPart, ...], told: Floats, ours: Floats) -> None:
    print(f"\npart  feed mm/s  rev/s   depth mm  print s   ours s      %   (side {SIDE} mm)")
    for part, one, other in zip(parts, told, ours, strict=True):
        told_of = part.settings
        print(
            f"{part.id:4}{told_of.feed:11.3f}{told_of.spindle_speed:9.4f}{told_of.depth:9.4f}"
            f"{one:9.2f}{other:9.2f}{100.0 * (other / one - 1.0):7.2f}"
        )


def _print_lines(parts: tuple[PrintedPart, ...], told: Floats, ours: Floats) -> None:
    print("\ntime = a + b/feed + c*|spindle speed|        print             ours")
    over, speed = slowness(parts), speeds(parts)
    for columns, names in (
        ([over], ("a, s", "b, mm")),
        ([over, speed], ("a, s", "b, mm", "c, s per rev/s")),
    ):
        one, other = line(columns, told), line(columns, ours)
        for row, name in enumerate(names):
            print(f"{name:38}{_of(one, row):>17}{_of(other, row):>17}")
        print(f"{'residual, rms s':38}{one.rms:17.3f}{other.rms:17.3f}")


def _of(found: FittedLine, row: int) -> str:
    return f"{found.coefficients[row]:.4g} ± {found.errors[row]:.2g}"


def _print_columns() -> None:
    """Columns of Fig. 11, print beside batches of ten that a shop has made."""
    with PRINT.open(encoding="ascii") as file:
        columns = {"print": dict(zip(NAMES, _columns(file).values(), strict=True))}
    for name in ("paper003", "paper003_cases"):
        with TemporaryDirectory() as folder:
            run_factory(
                EXAMPLES / "shops" / f"{name}.toml", FactoryRequest(), folder=Path(folder)
            )
            with (Path(folder) / f"{MILL}.csv").open(encoding="utf-8") as file:
                columns[name] = _columns(file)
    print(f"\n{'least to greatest':20}{'print':>25}{'pocket':>25}{'cases 1 and 2':>25}")
    for name in NAMES[1:]:
        shown = [_ends(found.get(name, ())) for found in columns.values()]
        print(f"{name:20}" + "".join(f"{each:>25}" for each in shown))


def _columns(file: TextIO) -> dict[str, tuple[float, ...]]:
    """Numbers of the columns of a table; what stands in one part of a batch only, there."""
    rows = list(csv.DictReader(file))
    return {
        name: tuple(float(row[name]) for row in rows if row[name] not in {"", "0"})
        if name != "id"
        else ()
        for name in rows[0]
        if name != "material"
    }


def _ends(values: Sequence[float]) -> str:
    return f"{min(values):.6g} to {max(values):.6g}" if values else ""


def _print_slots(cycles: PartCycles) -> None:
    print(
        "\nslot    time s  energy kJ  mean W  peak W  movements  deviation: sd of the energy %"
    )
    for case in (1, 2):
        program = Program.load(EXAMPLES / "parts" / f"paper003_case{case}.stpnc")
        cycle = cycles.cycle(program, MACHINE, material_for("", program))
        count = len(cycle.traverse_energies) + len(cycle.feed_energies)
        print(
            f"case {case}{cycle.time:9.1f}{1e-3 * cycle.energy:11.1f}"
            f"{cycle.energy / cycle.time:8.1f}{cycle.peak_power:8.0f}{count:11}"
            f"{100.0 * _spread(cycle):17.3f}"
        )


def _spread(cycle: PartCycle) -> float:
    """Standard deviation of the energy with deviation, over the energy."""
    if MACHINE.deviation is None:
        raise ValueError("the machine of the paper has a deviation")
    drawn = drawn_energies(cycle, MACHINE.deviation, np.random.default_rng(1), 20_000)
    return float(drawn.std()) / cycle.energy


def _print_interpolation(cycles: PartCycles) -> None:
    program = Program.load(POCKET)
    match = material_for("", program)
    ranges = [SettingRange(low=low, high=high) for low, high in zip(LOW, HIGH, strict=True)]
    design = SettingsDesign(feed=ranges[0], spindle_speed=ranges[1], depth=ranges[2])
    began = perf_counter()
    table = cycles.table(program, MACHINE, match, design)
    built = perf_counter() - began
    rows = np.random.default_rng(42).uniform(LOW, HIGH, (RUNS, 3))
    found = table.values(*rows.T)
    direct = [
        cycles.cycle(
            program,
            MACHINE,
            match,
            CutSettings(feed=feed, spindle_speed=-speed, depth=depth),
        )
        for feed, speed, depth in rows.tolist()
    ]
    print(
        f"\ninterpolated from {table.runs} runs in {built:.1f} s; greatest error beside {RUNS} "
        "direct runs:"
    )
    for name, values in (
        ("time", [each.time for each in direct]),
        ("energy", [each.energy for each in direct]),
        ("peak_power", [each.peak_power for each in direct]),
    ):
        error = np.abs(getattr(found, name) / np.array(values) - 1.0).max()
        print(f"  {name.replace('_', ' '):12}{100.0 * error:8.4f} %")
    many = np.random.default_rng(1).uniform(LOW, HIGH, (200_000, 3))
    began = perf_counter()
    table.values(*many.T)
    print(f"  {1e6 * (perf_counter() - began) / len(many):.2f} µs a part")


if __name__ == "__main__":
    main()
