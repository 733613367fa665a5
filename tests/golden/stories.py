"""Stories: commands that run one after another in a folder with the samples."""

from collections.abc import Mapping
from pathlib import Path

EXAMPLES = Path(__file__).parents[2] / "examples"

PARTS = (
    "bracket", "paper000", "paper002", "paper003_case1", "paper003_case2", "paper003_pocket",
    "shaft",
)  # fmt: skip

CODE = """%
O1001 (PLATE)
G21 G17 G90 G94 G54
T1 M6
S2000 M3
G0 G43 H1 Z20.
G0 X-15. Y10.
G0 Z-2.
G1 X115. F300.
G3 X115. Y40. I0. J15.
G1 X-15.
G0 Z20.
T2 M6
S1500 M3
G0 G43 H2 Z20.
G81 X20. Y20. Z-12. R2. F100.
X80.
G80
M5
M30
%
"""

TOOLS = """\
number,kind,diameter_mm,teeth,edge_length_mm,overhang_mm,holder_diameter_mm,cutting_material
1,endmill,16,4,32,50,32,carbide
2,drill,8,2,60,80,32,carbide
"""

STOCK = "0,0,-20,100,60,0"
PLATE = (
    "plate.nc", "--tools", "plate.csv", "--stock", STOCK, "--material", "c45", "--machine",
    "vmc15",
)  # fmt: skip

KB = ("--kb", "k.db")


def _advice() -> Mapping[str, tuple[tuple[str, ...], ...]]:
    """Stories of ``optimise``, one a sample."""
    stories: dict[str, tuple[tuple[str, ...], ...]] = {}
    for part in PARTS:
        file = f"{part}.stpnc"
        stories[f"optimise_{part}"] = (
            ("optimise", file, "--mode", "TC"),
            ("optimise", file, "--mode", "TC", "--json", "--dry-run"),
            ("optimise", file, "--mode", "QC", "--roughness", "1.6", "--dry-run"),
            ("optimise", file, "--mode", "EC", "--free", "feed,depth,speed", "--dry-run"),
            ("optimise", file, "--records", "none", "-o", "none.stpnc"),
            ("optimise", file, "--profile", "standard", "-o", "standard.stpnc"),
            ("optimise", f"{part}.optimised.stpnc", "--dry-run"),
        )
    return stories


def _programs() -> Mapping[str, tuple[tuple[str, ...], ...]]:
    """Stories of what reads programs, one a sample."""
    stories: dict[str, tuple[tuple[str, ...], ...]] = {}
    for part in PARTS:
        file = f"{part}.stpnc"
        machine = "lathe22" if part == "shaft" else "vmc15"
        stories[f"program_{part}"] = (
            ("check", file),
            ("check", file, "--json"),
            ("convert", file, "--to", "ap238", "-o", "ap238.stp"),
            ("check", "ap238.stp"),
            ("toolpath", file),
            ("toolpath", file, "--json"),
            ("post", file, "--control", "linuxcnc", "-o", "linuxcnc.ngc"),
            ("post", file, "--control", "sinumerik", "-o", "sinumerik.mpf"),
            ("post", file, "--control", "canonical", "-o", "posted.canon"),
            ("check", "linuxcnc.ngc"),
            ("canonical", "linuxcnc.ngc", "--control", "linuxcnc"),
            ("simulate", file, "--machine", machine),
            ("simulate", file, "--machine", machine, "--json"),
            ("cycletime", file, "--machine", machine),
        )
    return stories


STORIES: Mapping[str, tuple[tuple[str, ...], ...]] = {
    **_advice(),
    **_programs(),
    "bracket_along_path": (
        ("optimise", "bracket.stpnc", "--machine", "vmc15", "--along-path", "--nc", "linuxcnc",
         "--feeds-csv", "feeds.csv", "--report", "report.html", "--workingstep",
         "ROUGH POCKET"),
        ("optimise", "bracket.stpnc", "--machine", "vmc15", "--pareto", "--dry-run",
         "--workingstep", "FINISH POCKET", "--json"),
    ),
    "confirmed": (
        ("optimise", "paper002.stpnc", "--material", "c45", "--machine", "vmc15", "--confirm"),
        ("optimise", "shaft.stpnc", "--machine", "lathe22", "--confirm", "--json", "--dry-run"),
    ),
    "nc_code": (
        ("check", "plate.nc"),
        ("check", "plate.nc", "--json"),
        ("canonical", "plate.nc", "--control", "fanuc"),
        ("simulate", "--nc", *PLATE),
        ("simulate", "--nc", *PLATE, "--json", "-o", "plate.run.csv"),
        ("optimise", *PLATE),
        ("optimise", *PLATE, "--mark", "-o", "marked.nc", "--report", "plate.html"),
        ("optimise", *PLATE, "--json", "--dry-run"),
        ("optimise", *PLATE, "--mode", "EC"),
        ("cycletime", "plate.nc", "--machine", "vmc15"),
        ("optimise", "plate.nc"),
    ),
    "closed_loop": (
        ("control", "paper002.stpnc", "--machine", "vmc15", "--material", "c45", "--seed", "3",
         "--disturb", "kc:1.2", "--kb", "k.db", "-o", "run.csv"),
        ("control", "paper003_case1.stpnc", "--machine", "paper003", "--seed", "4", "--json",
         "--kb", "k.db"),
        ("kbe", "review", "--kb", "k.db"),
        ("kbe", "review", "--kb", "k.db", "--json"),
        ("kbe", "table", "--kb", "k.db"),
        ("kbe", "check", "--kb", "k.db"),
    ),
    "knowledge": (
        ("kbe", "add", "outcomes.json", "--kb", "k.db"),
        ("kbe", "add", "outcomes.json", "--kb", "k.db"),
        ("kbe", "list", "--limit", "4", *KB),
        ("kbe", "list", "--limit", "2", "--json", *KB),
        ("kbe", "list", "--machine", "vmc15", "--feature-kind", "slot", "--since", "2020-03-03",
         "--until", "2120-03-09T12:00Z", "--limit", "3", *KB),
        ("kbe", "list", "--machine", "lathe", *KB),
        ("kbe", "list", "--since", "2026-03-09", "--until", "2026-03-02", *KB),
        ("kbe", "list", "--limit", "0", *KB),
        ("kbe", "show", "000005", *KB),
        ("kbe", "show", "000005", "--json", *KB),
        ("kbe", "show", "9", *KB),
        ("kbe", "review", "--machine", "vmc15", "--material", "C45", *KB),
        ("kbe", "review", "--json", "--machine", "vmc15", "--tool", "DRILL 8.5", *KB),
        ("kbe", "corrections", "--json", *KB),
        ("kbe", "review", "--auto-accept", "--by", "A. Smith", "--least-confidence", "50%",
         "--fewest-outcomes", "2", "--greatest-change", "0.4", *KB),
        ("kbe", "corrections", *KB),
        ("kbe", "accept", "1", "2", "--by", "B. Jones", *KB),
        ("kbe", "accept", "99", "--by", "B. Jones", *KB),
        ("kbe", "withdraw", "2", "--by", "B. Jones", "--json", *KB),
        ("kbe", "show", "2", *KB),
        ("kbe", "check", *KB),
        ("kbe", "check", "--json", *KB),
        ("kbe", "backup", "copy.db", *KB),
        ("kbe", "restore", "copy.db", "--kb", "other.db", "--json"),
        ("kbe", "restore", "copy.db", "--kb", "other.db"),
    ),
    "evaluation": (
        ("kbe", "add", "outcomes.json", "--kb", "k.db"),
        ("kbe", "table", *KB),
        ("kbe", "table", "--json", "--by", "kind", "--sort", "time-to-win", *KB),
        ("kbe", "table", "--format", "csv", "--only", "with-remarks", *KB),
        ("kbe", "table", "--format", "html", "--machine", "vmc15", *KB),
        ("kbe", "table", "--format", "parquet", *KB),
        *(
            ("kbe", "table", "--only", "violated", "--sort", "force", "-o", f"table.{form}",
             *KB)
            for form in ("txt", "csv", "json", "html", "parquet", "xlsx")
        ),
        ("kbe", "table", "-o", "table.xlsx", "--format", "csv", *KB),
        ("kbe", "table", "--machine", "lathe", *KB),
        ("kbe", "table", "--machine", "lathe", "-o", "empty.html", *KB),
        ("kbe", "table", "--summary", *KB),
        ("kbe", "table", "--summary", "--json", "--material", "C45", *KB),
        ("kbe", "table", "--summary", "--format", "csv", *KB),
        ("kbe", "table", "--summary", "-o", "summary.csv", *KB),
        ("kbe", "table", "--summary", "-o", "summary.html", *KB),
        ("kbe", "table", "-o", "k.db", "--format", "csv", *KB),
        ("kbe", "review", "--machine", "vmc15", "--material", "C45", *KB),
        *(
            ("kbe", "export", what, "--run", "000005", "-o", f"{what}.{form}", *KB)
            for what in ("outcomes", "corrections", "table")
            for form in ("csv", "json", "html")
        ),
        ("kbe", "add", "plate.csv", *KB),
    ),
    "outcomes_in_program": (
        ("control", "paper003_case1.stpnc", "--machine", "paper003", "--seed", "4", "--kb",
         "k.db"),
        ("kbe", "review", "--auto-accept", "--by", "A. Smith", *KB),
        ("kbe", "write", "paper003_case1.stpnc", *KB),
        ("kbe", "write", "paper003_case1.stpnc", "--run", "nonsense", "-o", "other.stpnc", *KB),
        ("kbe", "write", "bracket.stpnc", *KB),
        ("kbe", "read", "paper003_case1.recorded.stpnc"),
        ("kbe", "read", "paper003_case1.recorded.stpnc", "--json"),
        ("kbe", "read", "paper003_case1.stpnc"),
        ("kbe", "read", "plate.nc"),
    ),
    "service": (
        ("keys", "list", "--data", "data"),
        ("keys", "create", "--for", "Anna", "--role", "operator", "--data", "data"),
        ("keys", "create", "--for", "Ben", "--data", "data"),
        ("keys", "create", "--for", " ", "--data", "data"),
        ("keys", "list", "--data", "data"),
        ("keys", "revoke", "nonsense", "--data", "data"),
        ("serve", "--data", "data", "--host", "0.0.0.0", "--tls-cert", "x.crt"),
        ("serve", "--data", "new", "--host", "0.0.0.0"),
        ("serve", "--data", "data", "--port", "70000"),
        ("serve", "--data", "data", "--rate", "nan"),
        ("serve", "--data", "data", "--agent", "vmc15"),
        ("serve", "--data", "data", "--agent", "x=http://127.0.0.1"),
        ("serve", "--data", "data", "--log-level", "loud"),
        ("serve", "--data", "data", "--job-memory", "1"),
    ),
    "verification": (
        ("simulate", "paper003_case1.stpnc", "--machine", "vmc15", "-o", "run.csv"),
        ("verify", "run.csv", "--program", "paper003_case1.stpnc", "--machine", "vmc15"),
        ("verify", "run.csv", "--program", "paper003_case1.stpnc", "--machine", "vmc15",
         "--json"),
    ),
    "library": (
        ("machines",), ("machines", "vmc15"), ("machines", "lathe22", "--json"),
        ("materials",), ("materials", "c45"), ("materials", "inconel718", "--json"),
    ),
    "blocks": (
        ("blocktest", "-o", "blocks.ngc", "--machine", "vmc15"),
        ("blocktest", "-o", "other.ngc", "--dialect", "nonsense"),
    ),
    "refused": (
        ("optimise", "missing.stpnc"),
        ("optimise", "paper002.stpnc", "--mode", "XX"),
        ("optimise", "paper002.stpnc", "--machine", "vmc16"),
        ("optimise", "paper002.stpnc", "--material", "titanum"),
        ("optimise", "paper002.stpnc", "--roughness", "-1"),
        ("optimise", "paper002.stpnc", "--finish", "T3"),
        ("optimise", "paper002.stpnc", "-o", "paper002.stpnc"),
        ("optimise", "shaft.stpnc", "--machine", "vmc15"),
        ("simulate", "--nc", "plate.nc"),
        ("simulate", "paper002.stpnc", "--machine", "nonsense"),
        ("post", "paper002.stpnc", "--control", "nonsense"),
        ("convert", "paper002.stpnc", "--to", "pdf", "-o", "x.pdf"),
        ("verify", "plate.csv", "--program", "paper002.stpnc", "--machine", "vmc15"),
        ("kbe", "review", "--kb", "nowhere/k.db"),
        ("control", "shaft.stpnc", "--machine", "nonsense"),
        ("score", "missing.csv", "--model", "missing.skops"),
    ),
}  # fmt: skip
"""Commands by the story's name."""
