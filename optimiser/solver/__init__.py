"""Optimum of one workingstep, of numbers that know no machining."""
