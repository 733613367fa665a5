"""The nouns: what a STEP-NC program says, in memory and on disk."""
