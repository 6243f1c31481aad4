# SPDX-License-Identifier: BSD-3-Clause
# Only the names that the package uses itself; __init__.pyi has all others.
class Error(ValueError): ...

_status_names: tuple[str, ...]

def _status_reason(status: int, subject: str) -> str: ...
