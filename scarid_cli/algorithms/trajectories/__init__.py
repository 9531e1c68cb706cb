"""Trajectories: limits that they keep, via points that they pass, finer samples of a reference."""
