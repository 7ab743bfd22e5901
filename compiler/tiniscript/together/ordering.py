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
    TakenChange,
    is_uid,
    page_and_count,
    taken_change_of,
    tree_of,
)
from tiniscript.together.operations import apply_change
from tiniscript.together.tree import Json, Tree

MAX_KEPT_CHANGES = 2000  # changes kept in memory, for returning pages
MAX_REFUSED = 100  # most refusals that a page is sent
MAX_PAGES = 200  # most pages whose last change is remembered


class SharedProgram:
    """`epoch` names this order of changes: after another one, pages begin with the whole."""

    def __init__(
        self, tree: Tree, epoch: str, keep: Callable[[Json], None] = lambda _: None,
        most_kept: int = MAX_KEPT_CHANGES,
    ) -> None:  # fmt: skip
        self.tree, self.epoch = tree, epoch
        self.number = 0
        self.taken_changes: list[TakenChange] = []
        self.last_count_by_page: dict[str, int] = {}  # count of the last decided change, by page
        # Id of the change and reason of its refusal, by page.
        self.refusals_by_page: dict[str, list[tuple[str, str]]] = {}
        self.keep = keep
        self._most_kept = most_kept
        self._checksum: tuple[int, int] | None = None  # number of the change, and its checksum

    def submit(self, changes: list[Change]) -> bool:
        """Decide on the changes of a page, in their order; return whether one was taken.

        A page sends all changes that it knows no decision on. So those that are missing were
        decided, and this computer has lost them: its disk was full before it crashed.
        """
        old_number = self.number
        for change in changes:
            if self._is_undecided(change.uid):
                self._decide(change)
        return self.number > old_number

    def refuse(self, uid: str, reason: str) -> None:
        """Refuse an invalid change."""
        if self._is_undecided(uid):
            self._refuse(uid, reason)

    def _is_undecided(self, uid: str) -> bool:
        page, count = page_and_count(uid)
        return count > self.last_count_by_page.get(page, 0)

    def _decide(self, change: Change) -> None:
        try:
            tree, operations, _ = apply_change(self.tree, change)
        except Refused as refusal:
            self._refuse(change.uid, refusal.reason)
            return
        taken_change = TakenChange(self.number + 1, change.uid, operations)
        self.keep(taken_change.data())
        self._take(tree, taken_change)

    def _take(self, tree: Tree, taken_change: TakenChange) -> None:
        page, count = page_and_count(taken_change.uid)
        self.tree, self.number = tree, taken_change.number
        self._note_count(page, count)
        self.taken_changes.append(taken_change)
        if len(self.taken_changes) > self._most_kept:
            del self.taken_changes[: self._most_kept // 10]

    def _refuse(self, uid: str, reason: str) -> None:
        self.keep({"uid": uid, "refused": reason})
        self._note_refused(uid, reason)

    def _note_refused(self, uid: str, reason: str) -> None:
        page, count = page_and_count(uid)
        self._note_count(page, count)
        self.refusals_by_page.setdefault(page, []).append((uid, reason))
        del self.refusals_by_page[page][:-MAX_REFUSED]

    def _note_count(self, page: str, count: int) -> None:
        self.last_count_by_page.pop(page, None)  # the newest is the last
        self.last_count_by_page[page] = count
        while len(self.last_count_by_page) > MAX_PAGES:
            oldest_page = next(iter(self.last_count_by_page))
            del self.last_count_by_page[oldest_page]
            self.refusals_by_page.pop(oldest_page, None)

    def news(self, page: str, since: int, epoch: str) -> Json:
        """Return the changes that a page lacks, or the whole program."""
        refusals = [list(taken_change) for taken_change in self.refusals_by_page.get(page, ())]
        news: Json = {"last": self.last_count_by_page.get(page, 0), "refused": refusals,
                      "n": self.number, "sum": self.checksum()}  # fmt: skip
        first_number = self.taken_changes[0].number if self.taken_changes else self.number + 1
        if epoch != self.epoch or not first_number - 1 <= since <= self.number:
            return {**news, "epoch": self.epoch, "whole": self.tree.snapshot()}
        return {
            **news,
            "changes": [
                taken_change.data()
                for taken_change in self.taken_changes[since - first_number + 1 :]
            ],
        }

    def checksum(self) -> int:
        if self._checksum is None or self._checksum[0] != self.number:
            self._checksum = self.number, self.tree.checksum()
        return self._checksum[1]

    # -- what is kept -----------------------------------------------------------------------------

    def snapshot(self) -> Json:
        """Return everything needed to continue, without the history."""
        return {"epoch": self.epoch, "n": self.number, "whole": self.tree.snapshot(),
                "counts": self.last_count_by_page,
                "refused": [list(refusal) for refusals in self.refusals_by_page.values()
                            for refusal in refusals]}  # fmt: skip

    def replay(self, rows: list[Json]) -> None:
        """Decide again as it was decided before. Leave out the first operation that does not fit,
        and all after it."""
        for row in rows:
            if "refused" in row and is_uid(row.get("uid")):
                self._note_refused(row["uid"], str(row["refused"]))
                continue
            with suppress(Refused):
                taken_change = taken_change_of(row)
                if taken_change.number == self.number + 1:
                    change = Change(taken_change.uid, taken_change.operations)
                    self._take(apply_change(self.tree, change, is_sure=True).tree, taken_change)
                    continue
            return


def program_of(snapshot: Json, keep: Callable[[Json], None] = lambda _: None) -> SharedProgram:
    """Return the program of a snapshot. Raises Refused."""
    number, epoch, counts = snapshot.get("n"), snapshot.get("epoch"), snapshot.get("counts")
    refusals = snapshot.get("refused")
    if type(number) is not int or not isinstance(epoch, str):
        raise Refused("bad")
    if not isinstance(counts, dict) or not isinstance(refusals, list):
        raise Refused("bad")
    program = SharedProgram(tree_of(snapshot.get("whole")), epoch, keep)
    program.number = number
    for refusal in refusals:
        if isinstance(refusal, list) and len(refusal) == 2 and is_uid(refusal[0]):
            program._note_refused(refusal[0], str(refusal[1]))
    program.last_count_by_page = {
        page: count for page, count in counts.items() if type(count) is int
    }
    return program
