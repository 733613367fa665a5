"""Closed-loop control of the feed override by the measured cutting force."""
