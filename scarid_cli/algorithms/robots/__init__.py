"""Robots: one TOML file each, read (`reading.py`) into one interface (`description.py`)."""
