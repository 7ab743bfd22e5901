"""The time that answers take on this line, learnt from earlier answers as in TCP.

The smoothed round trip, its variation, and the timer that doubles until an answer belongs to one
sending for certain are those of RFC 6298, https://www.rfc-editor.org/rfc/rfc6298. Times are
milliseconds. Knows no frame and no clock.
"""

from __future__ import annotations

ROUND_MS = 120  # round trip through two radios and a robot, without the bytes
MAX_LEARNT_MS = 3000  # a learnt timer may be wrong after a suspension
MAX_DOUBLED_MS = 1000  # doubling never exceeds this limit
MAX_RETRY_MS = 400  # the longest timer for a robot that has to hear us regularly
_MEAN_WEIGHT, _VARIATION_WEIGHT, _VARIATION_COUNT = 1 / 8, 1 / 4, 4  # alpha, beta and K of the RFC


class RoundTrips:
    def __init__(self, baud: int) -> None:
        self._baud = baud
        self.least_ms: int | None = None  # the shortest round trip; any more is time in a queue
        self._mean_ms: float | None = None
        self._variation_ms = 0.0
        self._byte_ms: float | None = None  # the longest time for a byte, as far as answers show
        self._is_certain = False  # an answer belonged to one sending for certain
        self._doublings = 0

    def add_round_trip(self, took_ms: int, byte_count: int, is_certain: bool) -> None:
        """Take how long an answer took that has, with its request, `byte_count` bytes.

        `is_certain` where it was one of several sendings that was answered: where it was not, that
        may have been a later one than the first, from which `took_ms` counts.
        """
        self.least_ms = took_ms if self.least_ms is None else min(self.least_ms, took_ms)
        byte_ms = took_ms / byte_count
        self._byte_ms = byte_ms if self._byte_ms is None else min(self._byte_ms, byte_ms)
        if not is_certain:
            return
        self._doublings, self._is_certain = 0, True
        if self._mean_ms is None:
            self._mean_ms, self._variation_ms = took_ms, took_ms / 2
            return
        self._variation_ms += (
            abs(self._mean_ms - took_ms) - self._variation_ms
        ) * _VARIATION_WEIGHT
        self._mean_ms += (took_ms - self._mean_ms) * _MEAN_WEIGHT

    def back_off(self) -> None:
        """Call this when no answer came in time. The time learnt from a request that was sent more
        than once may be too long: if no answer comes, the next wait is half as long, so that it is
        retried soon.
        """
        self._doublings += 1
        if self._byte_ms is not None and not self._is_certain:
            self._byte_ms /= 2

    def bytes_in(self, time_ms: int) -> int:
        """Return the bytes that this line carries at least in a time, as far as answers show."""
        return int(time_ms / max(10_000 / self._baud, self._byte_ms or 0))

    def wait_ms(self, byte_count: int, retries_soon: bool = False) -> int:
        """Return the time to wait for an answer of `byte_count` bytes, including its request.

        `retries_soon`: a robot that is silent is asked again soon, however long answers take.
        """
        line_ms = ROUND_MS + -(-byte_count * 10_000 // self._baud)
        learnt_ms = ROUND_MS + byte_count * (self._byte_ms or 0)
        if self._mean_ms is not None:
            learnt_ms = max(learnt_ms, self._mean_ms + _VARIATION_COUNT * self._variation_ms)
        needed_ms = max(line_ms, min(int(learnt_ms), MAX_LEARNT_MS))
        doubled_ms = needed_ms << min(self._doublings, 10)
        wait_ms = min(doubled_ms, max(MAX_DOUBLED_MS, needed_ms))
        return max(line_ms, min(wait_ms, MAX_RETRY_MS)) if retries_soon else wait_ms
