"""Executors of long work: processes of this machine, or a Dask cluster."""
