"""scarid: identify the dynamic parameters of robot manipulators, one small command per stage."""

__version__ = "0.1.0"
