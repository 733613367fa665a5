"""Fit a control's time for a block to a log of its test, or to a table.

A table has the columns spacing_in and feed_in_min, or spacing_mm and feed_mm_min. A log is
read beside the test program of `stepnc blocktest` that was run.
"""
