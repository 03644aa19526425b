"""The joint of a file whose columns do not number theirs: told by its name or by an id column."""

from contextlib import suppress

from frictioncli.logs.channels.recognition import id_column, joint_in_name
from frictioncli.logs.log_source import LogSource, UnreadableLog
from frictioncli.logs.runs.discovery import LogFile
from frictioncli.logs.runs.joint_rows import RowsOfJoint

_FIRST_BYTES = 1 << 14
_MOST_JOINTS = 100


def joint_of_file(file: LogFile, source: LogSource) -> int | None:
    """Return the joint that the name of a file or a column of joint numbers tells, if any.

    Parameters
    ----------
    file : LogFile
        The file.
    source : LogSource
        Its columns. Of a column such as ``motor_id``, the first rows are read; it tells nothing
        where they differ.
    """
    if isinstance(source, RowsOfJoint):
        return source.joint
    in_name = joint_in_name(file.stem)
    column = id_column(source.columns)
    if in_name is not None or column is None:
        return in_name
    with suppress(UnreadableLog):
        batch = next(iter(source.batches([column], _FIRST_BYTES)), None)
        numbers = set() if batch is None else set(batch.values[column].tolist())
        if len(numbers) == 1 and (number := numbers.pop()) in range(1, _MOST_JOINTS):
            return int(number)
    return None
