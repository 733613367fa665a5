"""A learned model on a machine that the physics does not know.

The pocket of ``08_paper001_learned.py`` on a mill as the physics has it, and on one with 15 %
more k_c and 60 W more idle power: models learn from few runs, 300 others test.
``python examples/09_hidden_machine.py [FOLDER]``
"""

import sys
from importlib.resources import files
from pathlib import Path

import pyarrow as pa
from pyarrow import compute, parquet

import stepnc
from extras.learning import source
from extras.learning.dataset_run import make_dataset
from extras.learning.verbs.learn.result import factor_text

DESIGN = f"""program = "{Path(__file__).resolve().parent}/parts/paper003_pocket.stpnc"
machine = "paper003"
feed_mm_s = [30, 90]
spindle_rad_s = [75.4, 226.2]
seed = 3
deviation = true
"""
COUNTS, ROWS = (20, 40, 100), 400
MODELS = [(kind, on) for on in (False, True) for kind in ("power-law", "gp", "mlp")]


def runs(folder: Path, material: str) -> pa.Table:
    design, rows = folder / "design.toml", folder / material.removesuffix(".toml")
    design.write_text(f'material = "{material}"\n{DESIGN}', encoding="utf-8")
    make_dataset(design, rows, rows=ROWS, tell=lambda text: None)
    return source.RowSource(rows).table(0, ROWS)


def main(folder: Path) -> None:
    steel = files("simulator").joinpath("data/materials/aisi1018.toml").read_text("utf-8")
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "hard.toml").write_text(steel.replace("= 1350", "= 1552.5", 1), encoding="utf-8")
    known, table = runs(folder, "aisi1018"), folder / "runs.parquet"
    power = compute.add(runs(folder, "hard.toml")["total_power_w"], 60.0)
    hidden = known.drop_columns("total_power_w").append_column("total_power_w", power)
    for title, measured in (("as the physics has it", known), ("hidden", hidden)):
        errors: dict[str, list[str]] = {}
        for count, (kind, on) in ((count, model) for count in COUNTS for model in MODELS):
            parquet.write_table(pa.concat_tables([measured[:count], measured[100:]]), table)
            found = stepnc.learn(table, model=kind, train=count, test=300, is_on_physics=on)
            for each in found.scored[: None if (kind, on) == MODELS[-1] else 1]:
                name = f"{kind} on the physics" if on and each.name == kind else each.name
                errors.setdefault(name, []).append(f"{each.scores.rmse.value:9.2f}")
        print(f"machine {title}, RMSE W".ljust(36), *(f"{each:4} runs" for each in COUNTS))
        print(*(" ".join((name.ljust(36), *row)) for name, row in errors.items()), sep="\n")
    print(factor_text(found))


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("build/hidden"))
