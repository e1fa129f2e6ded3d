"""How does an hour of samples become as many points as the screen has, without losing a peak or closing a gap?"""

import numpy as np

from core.samples import FloatArray


def thin(time_s: FloatArray, values: FloatArray, columns: int) -> tuple[FloatArray, FloatArray]:
    """Keep the lowest and the highest value of each of `columns` equal parts, in the order they came.

    A part without any value stays a gap; a missing sample beside others does not widen into one. What has no more than
    four samples per column is returned as it is.

    Parameters
    ----------
    time_s, values : (n,)
        Ascending; NaN in gaps.
    """
    per_column = len(values) // max(columns, 1)
    if per_column <= 4:
        return time_s, values
    n = len(values) // per_column * per_column
    parts = values[:n].reshape(-1, per_column)
    starts = np.arange(0, n, per_column)
    lowest = starts + np.argmin(np.where(np.isnan(parts), np.inf, parts), axis=1)
    highest = starts + np.argmax(np.where(np.isnan(parts), -np.inf, parts), axis=1)
    kept = np.sort(np.stack([lowest, highest], axis=1), axis=1).ravel()
    kept = np.concatenate([kept, np.arange(n, len(values))])
    return time_s[kept], values[kept]
