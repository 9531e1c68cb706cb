"""The median without numpy.ma is numpy's."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from scarid_cli.arrays import median

NUMBERS = st.floats(allow_nan=True, width=32)


@given(st.lists(NUMBERS, min_size=1, max_size=9))
def test_the_median_has_the_bits_of_numpys(values: list[float]) -> None:
    with np.errstate(invalid="ignore"):
        assert np.array_equal(median(np.array(values)), np.median(values), equal_nan=True)
