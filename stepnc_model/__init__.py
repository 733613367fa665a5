"""Data model of STEP-NC programs: Part 21 files, entities, tool paths and NC code."""
