"""What wine 8 lacks of Windows: the reason why a part of a file could not be locked.

Begins with Python there, as its `sitecustomize`.
"""

import sys

if sys.platform == "win32":
    import msvcrt

    _real = msvcrt.locking

    def _locking(number: int, mode: int, count: int, /) -> None:
        try:
            _real(number, mode, count)
        except OSError as why:
            if why.errno:
                raise
            raise PermissionError(13, "Permission denied") from None

    msvcrt.locking = _locking
