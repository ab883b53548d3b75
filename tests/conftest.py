"""Settings of the whole suite."""

import os

from hypothesis import settings

# A slow or busy machine must not fail a property; on a server every run tries the same examples.
settings.register_profile("suite", deadline=None, derandomize=bool(os.environ.get("CI")), print_blob=True)
settings.load_profile("suite")
