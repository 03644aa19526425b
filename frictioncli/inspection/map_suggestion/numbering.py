"""Which joint a column's name counts, also in names that are not known."""

import re
from collections import defaultdict
from collections.abc import Sequence

_LAST = re.compile(r"^(.*?)(\d{1,2})(\D*)$")


def joint_numbers(names: Sequence[str], time: int) -> dict[int, int]:
    """Return column -> joint from 1, for columns whose names count joints.

    Names that count something else, as ``c1`` to ``c9``, are known by the time being among them.
    Where one family begins at 0 all of them do.

    Parameters
    ----------
    names : sequence of str
        All column names.
    time : int
        Column of the time.
    """
    families: dict[tuple[str, str], dict[int, int]] = defaultdict(dict)
    for column, name in enumerate(names):
        parts = _LAST.match(name.strip())
        if parts:
            families[parts[1], parts[3]][column] = int(parts[2])
    counting = [family for family in families.values() if len(family) > 1 and time not in family]
    base = 0 if any(0 in family.values() for family in counting) else 1
    return {c: number + 1 - base for family in counting for c, number in family.items()}
