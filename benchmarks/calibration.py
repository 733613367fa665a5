"""Laws of measured cuts by the commands: few rows in, the rest predicted, with intervals.

Tables of measurements as others published them, read in place; a table that is absent is
skipped and said. Seeds are fixed. Rows are chosen, written as a table, and given to
``calibrate`` and ``validate``, as a shop would do.
"""

import argparse
import csv
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import stepnc
from extras.calibration.model.cut_fit import CutPrediction
from simulator.library import load_material
from simulator.physics.surface import RA_FLOOR, corner_coefficient
from simulator.physics.surface_spread import forecast, unmeasured_spread
from simulator.spec import WorkMaterial
from stepnc_model.units import mm_from_um, speed_from_m_min

DATA = Path(__file__).parents[2] / "shared" / "data"
MEASURED = DATA / "measured"
SUBSETS = 12
"""Choices of rows of each table."""

Row = Mapping[str, object]


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """Rows that are fitted, and rows that are predicted."""

    name: str
    material: str
    fit: Sequence[Row]
    test: Sequence[Row]


def main(arguments: Sequence[str] | None = None) -> None:
    """Print one table by quantity."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--subsets", type=int, default=SUBSETS, help="choices of each table")
    count = parser.parse_args(arguments).subsets
    print(
        f"{'table':<28}{'trials':>7}{'rows':>6}{'mean error':>11}{'worst':>8}"
        f"{'inside 90 %':>13}{'best simpler rule':>26}"
    )
    for name, trials in (
        ("kc_vs_feed_mitsubishi.csv", _catalogue()),
        ("turning_forces_paredes.csv", _turning(count)),
        ("fc_1045_chipbreaker.csv", _breakers(count)),
        ("ra_1045_hindawi.csv", _roughness(count)),
        ("nasa_mill_wear_cases_1-8.csv", _lives()),
    ):
        try:
            _print(list(trials))
        except FileNotFoundError:
            print(f"{name}: skipped, it is not in {DATA}")
    try:
        _print_surfaces(list(_roughness(count)))
    except FileNotFoundError:
        print(f"ra_1045_hindawi.csv: skipped, it is not in {DATA}")


SHARES = (0.5, 0.8, 0.9)


def _print_surfaces(trials: Sequence[Trial]) -> None:
    """Print the share of measured surfaces that are rougher than a plan promises."""
    table = [row for trial in trials for row in (*trial.fit, *trial.test)]
    # Each column of the table has trials of the same rows.
    surfaces = [dict(each) for each in {tuple(row.items()): None for row in table}]
    print(f"\n{'promise for a surface of AISI 1045':<52}{'surfaces':>9}{'rougher':>9}")
    start = load_material(STEEL)
    ideal = [_measured(row) > _ideal(row) + RA_FLOOR for row in surfaces]
    _print_share("ideal + 0.2 µm", ideal)
    for share in SHARES:
        found = [_measured(row) > _promised(start, row, share) for row in surfaces]
        _print_share(f"not measured, {100.0 * share:g} % of surfaces", found)
    for share in SHARES:
        found = [
            _measured(row) > _promised(material, row, share)
            for trial in trials
            for material in [learned(trial)]
            for row in trial.test
        ]
        _print_share(f"five own surfaces, {100.0 * share:g} % of surfaces", found)
    ratios = [
        _promised(material, row, SHARES[-1]) / _promised(material, row, SHARES[0])
        for trial in trials
        for material in [learned(trial)]
        for row in trial.test
    ]
    print(f"after five own surfaces the 90 % promise is {np.mean(ratios):.2f} × the median")


def _print_share(name: str, are_rougher: Sequence[bool]) -> None:
    print(f"{name:<52}{len(are_rougher):>9}{np.mean(are_rougher):>9.1%}")


def _ideal(row: Row) -> float:
    return (
        corner_coefficient(float(str(row["nose_radius_mm"]))) * float(str(row["feed_mm"])) ** 2
    )


def _measured(row: Row) -> float:
    return mm_from_um(float(str(row["ra_um"])))


def _promised(material: WorkMaterial, row: Row, share: float) -> float:
    """Ra that a share of surfaces keeps, mm."""
    found = forecast(
        material.surface or unmeasured_spread(material.iso_group),
        _ideal(row),
        cutting_speed=speed_from_m_min(float(str(row["cutting_speed_m_min"]))),
        is_dry=row["coolant"] == "dry",
    )
    return found.quantile(share)


def learned(trial: Trial) -> WorkMaterial:
    """Material with what the fitted rows teach, as the command writes it."""
    with TemporaryDirectory() as folder:
        fit, model = Path(folder) / "fit.csv", Path(folder) / "model.toml"
        _write(fit, trial.fit)
        stepnc.calibrate(
            table=str(fit), material=trial.material, output=str(model), anyway=True
        )
        return load_material(str(model))


def _print(trials: Sequence[Trial]) -> None:
    for name in dict.fromkeys(trial.name for trial in trials):
        same = [trial for trial in trials if trial.name == name]
        found = [each for trial in same for each in predicted(trial)]
        log_error = np.array([np.log(each.predicted / each.measured) for each in found])
        rules = {
            rule: float(
                np.mean(
                    np.abs(np.log([each.baselines[rule] / each.measured for each in found]))
                )
            )
            for rule in found[0].baselines
        }
        best = min(rules, key=lambda rule: rules[rule])
        inside = np.mean([each.is_inside for each in found])
        print(
            f"{name:<28}{len(same):>7}{len(found):>6}{np.expm1(np.abs(log_error).mean()):>11.1%}"
            f"{np.expm1(np.abs(log_error).max()):>8.0%}{inside:>13.1%}"
            f"{best + f' {np.expm1(rules[best]):.1%}':>26}"
        )


def predicted(trial: Trial) -> tuple[CutPrediction, ...]:
    """Calibrate a material to the fitted rows and validate it on the others."""
    with TemporaryDirectory() as folder:
        place = Path(folder)
        fit, test, model = (place / each for each in ("fit.csv", "test.csv", "model.toml"))
        _write(fit, trial.fit)
        _write(test, trial.test)
        stepnc.calibrate(
            table=str(fit), material=trial.material, output=str(model), anyway=True
        )
        return tuple(stepnc.validate(table=str(test), material=str(model)).predicted)


def _write(path: Path, rows: Sequence[Row]) -> None:
    names = list(dict.fromkeys(name for row in rows for name in row))
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, names)
        writer.writeheader()
        writer.writerows(rows)


def _read(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


STEEL = "c45"
FEEDS = ("0.1", "0.2", "0.3", "0.4", "0.6")


def _catalogue() -> Iterator[Trial]:
    """Half of the feeds of each material; the start is a catalogue value of another steel."""
    rows = _read(DATA / "kc_vs_feed_mitsubishi.csv")
    for row in rows:
        word = "turning" if row["process"] == "turn" else "milling"
        cuts = {
            feed: {
                "operation": word, "feed_mm": feed,
                "specific_cutting_force_n_mm2": row[f"kc_f{feed}"],
            }
            for feed in FEEDS
        }  # fmt: skip
        for name, chosen, asked in (
            ("k_c, between feeds", ("0.1", "0.3", "0.6"), ("0.2", "0.4")),
            ("k_c, greater feeds", ("0.1", "0.2"), ("0.4", "0.6")),
            ("k_c, smaller feeds", ("0.4", "0.6"), ("0.1", "0.2")),
        ):
            yield Trial(
                name=name, material=STEEL, fit=[cuts[each] for each in chosen],
                test=[cuts[each] for each in asked],
            )  # fmt: skip


def _chosen(name: str, rows: Sequence[Row], *, fit: int, count: int) -> Iterator[Trial]:
    """Some rows by chance, the others predicted."""
    rng = np.random.default_rng(36)
    for _ in range(count):
        order = rng.permutation(len(rows))
        yield Trial(
            name=name, material=STEEL, fit=[rows[at] for at in order[:fit]],
            test=[rows[at] for at in order[fit:]],
        )  # fmt: skip


def _turning(count: int) -> Iterator[Trial]:
    rows = [
        {
            "feed_mm": row["feed_timed_mm_rev"], "axial_depth_mm": row["depth_mm"],
            "cutting_force_n": row["cutting_force_n"],
        }
        for row in _read(MEASURED / "turning_forces_paredes.csv")
    ]  # fmt: skip
    yield from _chosen("forces, feed and depth", rows, fit=5, count=count)
    yield Trial(name="forces, greater feeds", material=STEEL, fit=rows[:2], test=rows[2:4])
    yield Trial(name="forces, smaller feeds", material=STEEL, fit=rows[2:4], test=rows[:2])


def _breakers(count: int) -> Iterator[Trial]:
    """Five rows of a chip breaker; the depth is not in the table."""
    table = _read(MEASURED / "fc_1045_chipbreaker.csv")
    for breaker in ("PF", "PM", "QM", "KR"):
        rows = [
            {
                "feed_mm": row["feed_mm_rev"], "chip_breaker": breaker,
                "cutting_speed_m_min": row["cutting_speed_m_min"],
                "cutting_force_n": row["cutting_force_n"],
            }
            for row in table
            if row["chip_breaker"] == breaker
        ]  # fmt: skip
        yield from _chosen("forces, chip breakers", rows, fit=5, count=max(1, count // 4))


def _roughness(count: int) -> Iterator[Trial]:
    """Five rows of a nose radius and coolant."""
    table = _read(MEASURED / "ra_1045_hindawi.csv")
    for column in ("r04_wet", "r04_dry", "r08_wet", "r08_dry"):
        radius, coolant = column[1:3], column[4:]
        rows = [
            {
                "feed_mm": row["feed_mm_rev"], "axial_depth_mm": row["depth_mm"],
                "cutting_speed_m_min": row["cutting_speed_m_min"],
                "nose_radius_mm": int(radius) / 10, "coolant": coolant,
                "ra_um": row[f"ra_um_{column}"],
            }
            for row in table
        ]  # fmt: skip
        yield from _chosen("roughness Ra", rows, fit=5, count=max(1, count // 4))


CASES = {"cast iron": "gg25", "steel J45": "42crmo4"}
MILL_SPEED = 200.0  # m/min of all cases, as the readme of the data set says


def _lives() -> Iterator[Trial]:
    """Leave each edge out; case 6 has one reading and no life."""
    table = _read(MEASURED / "nasa_mill_wear_cases_1-8.csv")
    for title, material in CASES.items():
        rows = [
            {
                "operation": "milling", "edge": row["case"], "cutting_speed_m_min": MILL_SPEED,
                "feed_mm": row["feed_mm_rev"], "axial_depth_mm": row["depth_mm"],
                "flank_wear_mm": row["flank_wear_mm"], "time_min": row["time_min"],
            }
            for row in table
            if row["material"] == title
        ]  # fmt: skip
        for edge in dict.fromkeys(row["edge"] for row in rows if row["edge"] != "6"):
            yield Trial(
                name="tool life", material=material,
                fit=[row for row in rows if row["edge"] != edge],
                test=[row for row in rows if row["edge"] == edge],
            )  # fmt: skip


if __name__ == "__main__":
    main()
