"""The virtual factory: a shop file run, its outputs and its report."""
