"""Publish a run on a virtual machine as an MTConnect agent.

FILE is a STEP-NC program that is run, or a recorded run (.parquet, .csv, .xml, .shdr, .log)
that is published again. With --device and --adapter, SHDR adapters of a machine are published.
The agent serves clients until it is interrupted.
"""
