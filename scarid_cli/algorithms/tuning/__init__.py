"""Choosing settings of differentiators from a log alone: likelihood, and search with a judge."""
