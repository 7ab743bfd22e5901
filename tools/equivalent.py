"""Changes of the C++ machine that change nothing, so that no test can notice them.

A line without the blanks around it, what it becomes, and why that is the same. A line that is no
longer in the machine leaves this list: `breaks.py` says so.
"""

from __future__ import annotations

EQUIVALENT = {
    (
        "sensors_ = sensors < kDevices ? sensors : kDevices;",
        "sensors_ = sensors < (kDevices + 1) ? sensors : kDevices;",
    ): "both sides are kDevices there",
}
