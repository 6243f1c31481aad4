# SPDX-License-Identifier: BSD-3-Clause
# What the package needs for itself; all else is in __init__.pyi.
class Error(ValueError): ...

_status_names: tuple[str, ...]

def _status_reason(status: int, subject: str) -> str: ...
