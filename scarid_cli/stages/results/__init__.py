"""The table of parameters: written, read, pooled, compared, predicted from."""
