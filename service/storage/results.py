"""Names of the files in the folder of a job, and of patterns by which some are removed."""

RESULT = "result.json"
OPTIMISED = "optimised.stpnc"
REPORT = "report.html"
SAMPLES = "samples.parquet"
NC_CODE = "program.nc"
FEEDS = "feeds.csv"
CURVES = "curves.json"
TABLE = "table"
"""Name of the files of an evaluation's table, without their suffixes."""
PLACES = "places"
"""Name of the files of places, without their suffixes."""
SURFACE = "surface.parquet"
LOG = "log.parquet"

UNFINISHED = (".*", "*.partial.*")
"""File name patterns of incomplete files, which no client can request."""

LARGE = (*UNFINISHED, "series.bin", SAMPLES, f"{PLACES}.*", SURFACE, LOG)
"""File name patterns of large files, removed to recover from a full disk."""
