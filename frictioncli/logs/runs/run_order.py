"""Order of the runs of a joint: that of their names, in which day 10 follows day 9."""

import pandas as pd

from frictioncli.logs.runs.discovery import natural_key


def runs_in_order(torques: pd.DataFrame) -> list[str]:
    """Return the names of the runs in order; the last one is held out.

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES`.

    Examples
    --------
    >>> runs_in_order(pd.DataFrame({"run": ["day10", "day2", "day10", "day1"]}))
    ['day1', 'day2', 'day10']
    """
    names = [str(name) for name in torques["run"].unique()]
    return sorted(names, key=lambda name: (natural_key(name), name))


def sorted_rows(torques: pd.DataFrame) -> pd.DataFrame:
    """Return rows in the order of run, time, pair and angle.

    Parameters
    ----------
    torques : DataFrame
        Rows of :data:`frictioncli.schemas.TORQUES` of one joint.

    Examples
    --------
    >>> rows = pd.DataFrame({"run": ["day10", "day2"], "time": 0.0, "pair": 1, "position": 5.0})
    >>> sorted_rows(rows)["run"].tolist()
    ['day2', 'day10']
    """
    place = {name: number for number, name in enumerate(runs_in_order(torques))}

    def key(column: pd.Series) -> pd.Series:
        return column.astype(str).map(place) if column.name == "run" else column

    return torques.sort_values(["run", "time", "pair", "position"], key=key)
