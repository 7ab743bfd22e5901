"""How much of something each of many may have: some at once, and then so much each second."""

from __future__ import annotations

MOST_NAMES = 1000  # who has not been seen for longest is forgotten


class Rate:
    """`burst` at once, `per_s` come back each second; for each name apart. `cost` of what is more
    than one."""

    def __init__(self, burst: float, per_s: float) -> None:
        self._burst = burst
        self._per_s = per_s
        self._amounts_left: dict[str, tuple[float, float]] = {}  # what was left, and when

    def has_left(self, name: str, now_s: float, cost: float = 1) -> bool:
        """Return whether so much is left."""
        return self._amount_left(name, now_s) >= cost

    def take_amount(self, name: str, now_s: float, cost: float = 1) -> bool:
        """Take so much, where it is left; return whether it was."""
        amount = self._amount_left(name, now_s)
        is_left = amount >= cost
        self._amounts_left.pop(name, None)
        if len(self._amounts_left) >= MOST_NAMES:
            del self._amounts_left[next(iter(self._amounts_left))]
        self._amounts_left[name] = (amount - cost if is_left else amount, now_s)
        return is_left

    def _amount_left(self, name: str, now_s: float) -> float:
        amount, when_s = self._amounts_left.get(name, (self._burst, now_s))
        return min(self._burst, amount + (now_s - when_s) * self._per_s)
