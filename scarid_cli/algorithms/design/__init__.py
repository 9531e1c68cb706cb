"""Optimal experiments: the information in a motion, its limits, and the search for the best one."""
