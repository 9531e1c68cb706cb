"""The one array type of the project: double precision, as the kernels take it."""

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
