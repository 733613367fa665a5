"""Holes: depths, feeds and the steps of the drilling family."""
