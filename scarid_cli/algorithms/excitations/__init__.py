"""Ways to excite a robot: a registry, in which each module is one choice of `scarid trajgen`."""
