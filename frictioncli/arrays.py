"""Types of the arrays that functions take and return; shapes stand in their docstrings."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
"""Numbers."""

ComplexArray = NDArray[np.complex128]
"""Complex numbers."""

Numbers = NDArray[np.int64]
"""Whole numbers: counts, bins, positions in a table."""

Indices = NDArray[np.intp]
"""Positions in an array."""

Flags = NDArray[np.bool_]
"""Yes or no for every row."""
