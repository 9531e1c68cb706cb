"""Robots: one TOML file each, read into one interface (`description.py`)."""
