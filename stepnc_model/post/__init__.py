"""NC code: neutral blocks, the dialects of controls, and a reader for each."""
