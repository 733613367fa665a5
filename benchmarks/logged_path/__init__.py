"""The path of a run, rebuilt from its logged positions, and the time its control takes for it.

For :mod:`benchmarks.umich` so far: no command of the product rebuilds a path from a log yet.
"""
