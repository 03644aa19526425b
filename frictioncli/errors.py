"""The faults that a user can mend.

Each message says where (file, row or column), what was found, what was expected and what to do.
The command line prints it and exits with status 2; any other exception is a bug.
"""


class FrictionError(Exception):
    """Base of every fault that lies in the input, an option or the work folder."""


class LogError(FrictionError):
    """A log file cannot be used: nothing in it that could be read as a joint's motion."""


class MappingError(FrictionError):
    """A mapping file or manifest says something that cannot be followed."""


class TableError(FrictionError):
    """A table of the work folder is missing, damaged or not of the expected form."""


class NotEnoughData(FrictionError):
    """The data are readable but do not hold what this step needs."""


class OptionError(FrictionError):
    """An option has a value that makes no sense here."""
