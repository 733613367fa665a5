"""Supervision of a run by its forces: warnings, broken teeth, wear."""
