"""Rate limits by name: a burst at once, and then so much each second."""

from __future__ import annotations

MAX_NAMES = 1000  # most names kept; the least recent is forgotten first


class Rate:
    """A rate limit for each name: `burst` at once, and `per_s` more each second. `cost` is that of
    several.
    """

    def __init__(self, burst: float, per_s: float) -> None:
        self._burst = burst
        self._per_s = per_s
        # Remaining amount, and the time it was measured.
        self._amounts_left: dict[str, tuple[float, float]] = {}

    def has_left(self, name: str, now_s: float, cost: float = 1) -> bool:
        """Return whether so much is left."""
        return self._amount_left(name, now_s) >= cost

    def take_amount(self, name: str, now_s: float, cost: float = 1) -> bool:
        """Take so much, where it is left; return whether it was."""
        amount = self._amount_left(name, now_s)
        is_left = amount >= cost
        self._amounts_left.pop(name, None)
        if len(self._amounts_left) >= MAX_NAMES:
            del self._amounts_left[next(iter(self._amounts_left))]
        self._amounts_left[name] = (amount - cost if is_left else amount, now_s)
        return is_left

    def _amount_left(self, name: str, now_s: float) -> float:
        amount, when_s = self._amounts_left.get(name, (self._burst, now_s))
        return min(self._burst, amount + (now_s - when_s) * self._per_s)
