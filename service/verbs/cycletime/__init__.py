"""Estimate a program's cycle time from the block rate, and compare it with a log."""
