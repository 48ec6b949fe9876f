"""The one name for arrays in annotations."""

import numpy as np

Array = np.ndarray
