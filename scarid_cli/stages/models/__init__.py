"""Identified robots in the forms that other programs take."""
