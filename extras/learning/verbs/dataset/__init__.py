"""Run parts by a design of experiments, as Parquet for learning.

Rows that are in the folder are kept: a run that was interrupted goes on where it ended.
"""
