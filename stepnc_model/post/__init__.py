"""Postprocessing to NC code: neutral blocks, a writer and a reader for each dialect."""
