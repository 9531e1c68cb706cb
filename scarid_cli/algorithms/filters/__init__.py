"""Filters and observers, and the base classes of the differentiators that are made of them."""
