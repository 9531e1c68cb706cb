"""Tables in files and streams: CSV, Parquet and Arrow."""

FORMATS = ("csv", "parquet", "arrow", "arrow-file")
