"""Robots: descriptions in TOML or URDF (`reading.py`) behind one interface (`description.py`)."""
