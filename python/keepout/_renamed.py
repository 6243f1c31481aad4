# SPDX-License-Identifier: BSD-3-Clause
"""Attributes under their names before version 0.3; each access warns. Version 0.4 will remove them."""

import warnings


def alias(owner, former, name):
    """Gives a class the attribute `former`, which warns and returns the attribute `name`."""

    def get(self):
        warnings.warn(f"{owner.__name__}.{former} is now {name}", DeprecationWarning, stacklevel=2)
        return getattr(self, name)

    setattr(owner, former, property(get, doc=f"Deprecated: use {name}."))
