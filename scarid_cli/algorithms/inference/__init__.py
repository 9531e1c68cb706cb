"""From the rows of a log to its outcome (outcome.py): estimates, errors, reasons, verdict."""
