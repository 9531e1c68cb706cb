"""The quick look of `scarid plot`: any table as curves or intervals, on a terminal or in a file."""
