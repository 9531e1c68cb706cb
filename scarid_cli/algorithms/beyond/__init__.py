"""What a log may have beyond the model of its robot: a catalogue with a class for each entry.

`identify`, `validate` and the pages read it. catalogue.py lists the entries.
"""
