# SPDX-License-Identifier: BSD-3-Clause
# What the package needs for itself; all else is in __init__.pyi.
class Error(ValueError): ...

status_names: tuple[str, ...]

def status_reason(status: int, subject: str) -> str: ...
