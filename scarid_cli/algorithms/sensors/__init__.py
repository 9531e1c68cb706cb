"""What lies between the simulated robot and the rows of its log: sensors, delays, the logger."""
