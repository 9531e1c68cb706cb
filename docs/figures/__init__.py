"""The figures of the documentation, each made from scarid commands: `make figures`.

A module makes one figure. Its docstring quotes the commands, `data` runs them and returns what is
drawn, which is kept beside it as JSON, and `drawn` draws it. A test compares the kept data with
what the commands give now, where that is quick.
"""
