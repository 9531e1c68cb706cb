"""The kinds of table that scarid reads and writes, as Frictionless Table Schemas."""
