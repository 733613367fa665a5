"""What a fork server has loaded, kept out of garbage collection; the last module of its list.

A collection in a job would otherwise touch, and thereby copy, all that the jobs share.
"""

import gc

gc.collect()
gc.freeze()
