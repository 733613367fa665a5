"""Exit codes of the command line; 2 is argparse's, for a wrong usage."""

OK, BAD_INPUT, INFEASIBLE, LIMIT_EXCEEDED, NOTHING_ADVISED = 0, 3, 4, 5, 6
"""Exit codes; with ``NOTHING_ADVISED`` ``optimise`` says that it wrote no program."""
