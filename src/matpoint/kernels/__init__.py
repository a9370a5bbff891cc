"""Compiled loops over plain arrays and scalars; they know nothing of matpoint's objects."""

import numpy as np

#: In the place of a list of points: all of them, in their own order.
EVERY_POINT = np.zeros(0, dtype=np.int32)
