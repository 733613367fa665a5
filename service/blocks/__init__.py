"""Time of blocks: the test of the block rate, its fit, and cycle times that follow."""
