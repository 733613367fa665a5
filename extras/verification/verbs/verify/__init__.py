"""Compare the part that logged positions left with the programmed one.

Without a program, name --tools, --stock, --required and --machine. A deviation beyond its
uncertainty and the tolerance ends with exit code 5.
"""
