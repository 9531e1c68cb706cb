"""Errors of estimates, from their rows alone."""
