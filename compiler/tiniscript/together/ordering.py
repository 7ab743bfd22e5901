"""The shared program on the class's computer: it orders changes, takes or refuses each, keeps them.

A page counts its changes; each is decided once, in the order of its count. Knows no network and no
file: what is decided goes to a `keep` before anybody hears of it.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress

from tiniscript.together.form import (
    Change,
    Refused,
    Taken,
    is_uid,
    page_and_count,
    taken_of,
    tree_of,
)
from tiniscript.together.operations import applied
from tiniscript.together.tree import Json, Tree

KEPT = 2000  # changes in memory, for pages that come back
MOST_REFUSED = 100  # of a page: what it is told
MOST_PAGES = 200  # of which it is known what was decided


class SharedProgram:
    """`epoch` names this order of changes: after another one, pages begin with the whole."""

    def __init__(
        self, tree: Tree, epoch: str, keep: Callable[[Json], None] = lambda _: None,
        most_kept: int = KEPT,
    ) -> None:  # fmt: skip
        self.tree, self.epoch = tree, epoch
        self.number = 0
        self.log: list[Taken] = []
        self.counts: dict[str, int] = {}  # by page, the last of its changes that is decided
        self.refused: dict[str, list[tuple[str, str]]] = {}  # by page: which, and why
        self.keep = keep
        self._most_kept = most_kept
        self._sum: tuple[int, int] | None = None  # of which number, and which

    def submit(self, changes: list[Change]) -> bool:
        """Decide on the changes of a page, in their order; return whether one was taken."""
        number = self.number
        for change in changes:
            page, count = page_and_count(change.uid)
            last = self.counts.get(page, 0)
            if count > last + 1:
                break  # one is missing: the page sends it again
            if count == last + 1:
                self._decide(change)
        return self.number > number

    def refuse(self, uid: str, why: str) -> None:
        """Refuse what is no change, if its turn has come."""
        page, count = page_and_count(uid)
        if count == self.counts.get(page, 0) + 1:
            self._refuse(uid, why)

    def _decide(self, change: Change) -> None:
        try:
            tree, done, _ = applied(self.tree, change)
        except Refused as refused:
            self._refuse(change.uid, refused.why)
            return
        taken = Taken(self.number + 1, change.uid, done)
        self.keep(taken.data())
        self._take(tree, taken)

    def _take(self, tree: Tree, taken: Taken) -> None:
        page, count = page_and_count(taken.uid)
        self.tree, self.number = tree, taken.number
        self._count(page, count)
        self.log.append(taken)
        if len(self.log) > self._most_kept:
            del self.log[: self._most_kept // 10]

    def _refuse(self, uid: str, why: str) -> None:
        self.keep({"uid": uid, "refused": why})
        self._note_refused(uid, why)

    def _note_refused(self, uid: str, why: str) -> None:
        page, count = page_and_count(uid)
        self._count(page, count)
        self.refused.setdefault(page, []).append((uid, why))
        del self.refused[page][:-MOST_REFUSED]

    def _count(self, page: str, count: int) -> None:
        self.counts.pop(page, None)  # the newest is the last
        self.counts[page] = count
        while len(self.counts) > MOST_PAGES:
            oldest = next(iter(self.counts))
            del self.counts[oldest]
            self.refused.pop(oldest, None)

    def news(self, page: str, since: int, epoch: str) -> Json:
        """Return what a page has not got yet: changes, or the whole."""
        refused = [list(each) for each in self.refused.get(page, ())]
        found: Json = {"last": self.counts.get(page, 0), "refused": refused, "n": self.number,
                       "sum": self.checksum()}  # fmt: skip
        first = self.log[0].number if self.log else self.number + 1
        if epoch != self.epoch or not first - 1 <= since <= self.number:
            return {**found, "epoch": self.epoch, "whole": self.tree.snapshot()}
        return {**found, "changes": [each.data() for each in self.log[since - first + 1 :]]}

    def checksum(self) -> int:
        if self._sum is None or self._sum[0] != self.number:
            self._sum = self.number, self.tree.checksum()
        return self._sum[1]

    # -- what is kept -----------------------------------------------------------------------------

    def snapshot(self) -> Json:
        """Return all that one goes on with; the history is not in it."""
        return {"epoch": self.epoch, "n": self.number, "whole": self.tree.snapshot(),
                "counts": self.counts}  # fmt: skip

    def replay(self, rows: list[Json]) -> None:
        """Decide again as it was decided before. What does not fit is left out, with all after."""
        for row in rows:
            if "refused" in row and is_uid(row.get("uid")):
                self._note_refused(row["uid"], str(row["refused"]))
                continue
            with suppress(Refused):
                taken = taken_of(row)
                if taken.number == self.number + 1:
                    change = Change(taken.uid, taken.operations)
                    self._take(applied(self.tree, change, is_sure=True).tree, taken)
                    continue
            return


def program_of(snapshot: Json, keep: Callable[[Json], None] = lambda _: None) -> SharedProgram:
    """Return the program of a snapshot. Raises Refused."""
    number, epoch, counts = snapshot.get("n"), snapshot.get("epoch"), snapshot.get("counts")
    if type(number) is not int or not isinstance(epoch, str) or not isinstance(counts, dict):
        raise Refused("bad")
    program = SharedProgram(tree_of(snapshot.get("whole")), epoch, keep)
    program.number = number
    program.counts = {page: count for page, count in counts.items() if type(count) is int}
    return program
