"""What each command does: `run(job, ...)` in the module of the command's name.

A module here is imported when its command runs, never for `--help`; so its imports stand at the
top as in any other module. `run` takes the options of the command's declaration by name.
"""
