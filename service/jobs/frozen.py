"""Freezes what a fork server has loaded out of garbage collection; last module of its list.

A collection in a job would otherwise touch, and thereby copy, all that the jobs share.
"""

import gc

gc.collect()
gc.freeze()
