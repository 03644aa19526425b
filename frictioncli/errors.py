"""Errors that a user can correct.

Each message states where the error is (file, row or column), what was found, what was expected and
what to do. The command line prints it and exits with status 2. Any other exception is a bug.
"""


class FrictionError(Exception):
    """Base of all errors in the input, an option or the work folder."""


class LogError(FrictionError):
    """A log file holds nothing that can be read as the motion of a joint."""


class MappingError(FrictionError):
    """A mapping file or manifest has an entry that cannot be applied."""


class TableError(FrictionError):
    """A table or document of the work folder is missing, damaged or not of the expected form."""


class NotEnoughData(FrictionError):
    """The data can be read but do not contain what this step needs."""


class OptionError(FrictionError):
    """An option has an invalid value."""
