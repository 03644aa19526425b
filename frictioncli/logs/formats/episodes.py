"""Episodes in one table, each with a time of its own, as LeRobot has them."""

from dataclasses import dataclass

import numpy as np

from frictioncli.arrays import Array

TIME, EPISODE = "timestamp", "episode_index"
"""Columns of LeRobot's tables: time since the episode began [s], and its number."""

PAUSE = 1.0
"""Time between episodes where their own times begin anew: the table does not tell it. [s]"""


@dataclass(slots=True)
class EpisodeClock:
    """Puts the episodes of a table one after the other on one time axis.

    Attributes
    ----------
    episode, time : float
        Episode and its own time in the last row; NaN before the first.
    offset : float
        What the time axis has more than the episode's own time. [s]
    """

    episode: float = np.nan
    time: float = np.nan
    offset: float = 0.0

    def continued(self, time: Array, episode: Array) -> Array:
        """Return the times of the next rows on the common axis.

        A time that goes on over the episodes stays as it is.

        Parameters
        ----------
        time : ndarray, shape (rows,)
            Time of each row. [s]
        episode : ndarray, shape (rows,)
            Number of its episode.

        Examples
        --------
        >>> import numpy as np
        >>> EpisodeClock().continued(np.array([0.0, 0.1, 0.0, 0.1]), np.array([4, 4, 5, 5]))
        array([0. , 0.1, 1.1, 1.2])
        """
        if not len(time):
            return time
        before = np.append(self.episode, episode[:-1])
        earlier = np.append(self.time, time[:-1])
        found = np.empty(len(time))
        start = 0
        for begin in np.flatnonzero((episode != before) & (time <= earlier)).tolist():
            found[start:begin] = time[start:begin] + self.offset
            self.offset += float(earlier[begin] - time[begin]) + PAUSE
            start = begin
        found[start:] = time[start:] + self.offset
        self.episode, self.time = float(episode[-1]), float(time[-1])
        return found
