"""What all tests share: properties are tried on the same examples each time."""

import sys

from hypothesis import settings

# otherwise the program would leave out the warnings of libraries, which are errors in the tests
sys.warnoptions.append("default::RuntimeWarning")


settings.register_profile("fixed", deadline=None, derandomize=True)
settings.load_profile("fixed")
