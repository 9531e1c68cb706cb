"""Settings of differentiators from a log alone: the likelihood, and a search with a judge."""
