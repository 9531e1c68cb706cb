"""The page of a fleet: one row a log, the course of each parameter, failures first."""
