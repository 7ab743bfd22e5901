"""A pupil's page of a shared program: what it shows, and what becomes of what is typed there.

It applies its own changes at once, over what has arrived; what is refused is not there any more. A
line that does not parse yet, or in which a key was just pressed, is a draft: text in the place of
lines, or behind one. Only lines without drafts become operations, so no characters of two pupils
are ever merged. Runs in the page's Pyodide; knows no network and no editor.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from difflib import SequenceMatcher
from typing import Any

from tiniscript.syntax.formatter import pieces_of
from tiniscript.syntax.lexer import scan
from tiniscript.together import differences
from tiniscript.together.differences import CutOut
from tiniscript.together.form import (
    IS_GONE,
    MOST_OPERATIONS,
    Change,
    Condition,
    Delete,
    Operation,
    Refused,
    Replace,
    change_of,
    data_of_change,
    page_and_count,
    taken_of,
    tree_of,
)
from tiniscript.together.layout import (
    OF_END,
    OWN,
    Key,
    Line,
    Unparsed,
    lines,
    mistaken_lines,
    read,
)
from tiniscript.together.operations import applied, conditions, do_hold
from tiniscript.together.tree import DO, ROOT, START, TEXT, Json, Tree, kind_of

MOST_UNDONE = 200  # own changes that can be taken back
MOST_STEPS = 1000  # from what has gone to what is there


@dataclass(eq=False)
class Draft:
    """`rows` in the place of the lines of `covers`, or behind the line of `above`.

    `stays`: it waits until its pupil goes on with it: somebody has deleted the instruction, or the
    page was loaded again.
    """

    rows: list[str]
    covers: tuple[Key, ...]
    above: Key | None
    stays: bool = False


@dataclass(eq=False)
class Item:
    """A line as it is shown: of the program (`keys`), or of a draft, which may have none."""

    text: str | None
    keys: tuple[Key, ...] = ()
    draft: Draft | None = None


@dataclass(eq=False)
class Hunk:
    """Items that the lines from `first` to `last`, not included, take the place of, and whose lines
    these hide: no line is hidden by two."""

    items: list[Item]
    covers: tuple[Key, ...]
    first: int
    last: int


@dataclass(eq=False)
class Undo:
    operations: tuple[Operation, ...]
    conditions: tuple[Condition, ...]


@dataclass(eq=False)
class Page:
    """`base` is what the class's computer has told, `view` that with the own `pending` changes."""

    name: str
    base: Tree = field(default_factory=Tree)
    number: int = 0
    epoch: str = ""
    text: list[str] = field(default_factory=list)
    caret: int = 0
    is_hot: bool = False  # a key was pressed in the line of the caret since the caret came there
    pending: list[Change] = field(default_factory=list)
    drafts: list[Draft] = field(default_factory=list)
    told: list[tuple[str, str]] = field(default_factory=list)  # what was refused, and why
    count: int = 0  # of own changes
    ids: int = 0
    is_astray: bool = False  # its tree is another than the computer's: it needs the whole

    def __post_init__(self) -> None:
        self.view = self.base
        self._undos: list[Undo] = []
        self._undoing: set[str] = set()  # uids of what takes something back
        self._lately: dict[str, list[str]] = {}
        self._uncut: set[str] = set()  # what is there again, since its delete was refused
        self._items: list[Item] = []
        self._redos: list[Undo] = []
        self._redoing: set[str] = set()
        self._owners: list[str] | None = None  # of the lines of the text, where blocks say so
        self._show()

    def copy(self) -> Page:
        """Return one that goes on from here: what happens to either is not seen by the other."""
        new = Page(self.name, self.base, self.number, self.epoch, self.text[:], self.caret,
                   self.is_hot, self.pending[:], self.drafts[:], self.told[:], self.count, self.ids,
                   self.is_astray)  # fmt: skip
        new.view, new.text, new.caret, new._items = self.view, self.text, self.caret, self._items
        new._undos, new._undoing, new._uncut = self._undos[:], {*self._undoing}, {*self._uncut}
        new._redos, new._redoing = self._redos[:], {*self._redoing}
        new._lately = {text: ids[:] for text, ids in self._lately.items()}
        return new

    # -- the storage of the browser: a reload goes on from it -------------------------------------

    def kept(self) -> Json:
        return {
            "name": self.name,
            "count": self.count,
            "ids": self.ids,
            "pending": [data_of_change(each) for each in self.pending],
            "undoing": sorted(self._undoing),
            "drafts": [[each.rows, each.covers, each.above] for each in self.drafts],
            "row": self.text[self.caret] if self.text else "",
        }

    @classmethod
    def of(cls, name: str, news: Json, kept: Json | None = None) -> Page:
        """Return the page that begins with the whole; one that was loaded again, with what it has
        kept, whatever its name was: a draft stays until its pupil goes on with it.

        Raises Refused, and what a damaged store raises: KeyError, TypeError, ValueError.
        """
        page = cls(name, tree_of(news["whole"]), news["n"], news["epoch"])
        refused: list[Change] = []
        if kept is not None:
            page.pending = list(map(change_of, kept["pending"]))
            if kept["name"] == name:
                page.count, page.ids = int(kept["count"]), int(kept["ids"])
                page._undoing = set(kept["undoing"])
            else:  # what is there already is not put in again
                page.pending = [change._replace(uid=f"{name}:{k}")
                                for k, change in enumerate(page.pending, 1)]  # fmt: skip
                page.count = len(page.pending)
            page.drafts = [
                Draft(list(rows), tuple(map(_key, covers)), _key(above) if above else None, True)
                for rows, covers, above in kept["drafts"]
                if rows  # what was only taken out is there again
            ]
            refused = page._decide(news)
        page._rebase()
        page._keep_typed(refused)
        page._show()
        if kept is not None and kept["row"] in page.text:
            page.caret = page.text.index(kept["row"])
        return page

    # -- own changes ------------------------------------------------------------------------------

    def new_id(self) -> str:
        self.ids += 1
        return f"{self.name}.{self.ids}"

    def do(self, operations: Iterable[Operation], undo: Undo | None = None) -> bool:
        """Apply own operations at once; what is not possible here is not sent."""
        made = tuple(operations)
        change = Change(f"{self.name}:{self.count + 1}", made, undo.conditions if undo else (),
                        self.number)  # fmt: skip
        if not made or len(made) > MOST_OPERATIONS:
            return False
        try:
            found = applied(self.view, change)
        except Refused:
            return False
        before, self.view = self.view, found.tree
        for each in made:
            for id in each.ids if isinstance(each, Delete) else ():
                if id in before:
                    self._lately.setdefault(before[id].text, []).append(id)
        self.count += 1
        self.pending.append(change)
        return True

    def write(self, text: list[str], owners: list[str]) -> None:
        """Blocks have become this text, of which `owners` says whose each line is."""
        self.type(text, self.caret)
        self._owners = owners
        self.leave()
        self._owners = None

    def follow(self, other: Page, before: Page) -> None:
        """Do what another page has done since it was a copy of `before`."""
        self.ids = other.ids
        lost = [change for change in other.pending[len(before.pending) :]
                if not self.do(change.operations)]  # fmt: skip
        were = [(draft.rows, draft.covers) for draft in before.drafts]
        own = [draft for draft in self.drafts if (draft.rows, draft.covers) not in were]
        self.drafts = [*other.drafts, *own]
        self._keep_typed(lost)
        self.told += [(change.uid, IS_GONE) for change in lost]
        self._show(self.caret)

    def undo(self) -> bool:
        """Take back the newest own change that nobody has changed since."""
        return self._take_back(self._undos, self._undoing)

    def redo(self) -> bool:
        """Take back the newest undo, where no own change came after it."""
        return self._take_back(self._redos, self._redoing)

    def _take_back(self, all: list[Undo], uids: set[str]) -> bool:
        self.leave()
        for undo in reversed(all):
            if do_hold(self.view, undo.conditions) and self.do(undo.operations, undo):
                all.remove(undo)
                uids.add(self.pending[-1].uid)
                self._show(self.caret)
                return True
        return False

    # -- typing -----------------------------------------------------------------------------------

    def type(self, text: list[str], caret: int, is_hot: bool = False) -> None:
        """The editor has this text now. Nothing is made of it before `flush`."""
        self.text, self.is_hot = text, is_hot
        self.caret = min(caret, max(0, len(text) - 1))

    def leave(self) -> None:
        """The caret has left its line: by Enter, an arrow, a press elsewhere, or the run button."""
        self.is_hot = False
        self.flush()

    def flush(self) -> None:
        """Make operations of what is finished, and drafts of the rest, and of a hot line."""
        if self.text == [item.text for item in self._shown()] and not self.drafts:
            return
        hunks = self._hunks()
        if not hunks:
            return
        wrong = mistaken_lines("\n".join(self.text))
        if self.is_hot:
            wrong |= {self.caret}
        bad = [hunk for hunk in hunks if any(hunk.first <= k < hunk.last for k in wrong)]
        held = [hunk for hunk in hunks if hunk in bad or self._waits(hunk)]
        if (wrong and not bad) or self._splits(hunks, held):
            held = hunks
        for choice in (held, hunks):
            if self._make_changes(hunks, choice):
                self.drafts = self._drafts(choice)
                at = [(draft, self.caret - hunk.first)
                      for draft, hunk in zip(self.drafts, choice, strict=True)
                      if hunk.first <= self.caret < hunk.last]  # fmt: skip
                self._show(self.caret, at[0] if at else None)
                return
        self._show(self.caret)

    def give_up(self) -> None:
        """Take out what does not parse."""
        self.flush()
        self.is_hot = False
        self.drafts = []
        self._show()

    def _make_changes(self, hunks: list[Hunk], held: list[Hunk]) -> bool:
        """Make changes of all but what is held; return whether that was possible."""
        try:
            self._revive(hunk for hunk in hunks if hunk not in held)
            made = differences.operations(
                self.view, self._text_without(held), self.new_id,
                CutOut(self._lately, self._uncut), self._owners and self._owners_without(held),
            )  # fmt: skip
        except (Unparsed, Refused):
            return False
        # New values are changes of their own: one that is refused takes no other with it.
        shape = [each for each in made if not isinstance(each, Replace)]
        if shape and not self.do(shape):
            return False
        for each in made:
            if isinstance(each, Replace):
                self.do([each])
        return True

    def _shown(self) -> list[Item]:
        return [item for item in self._items if item.text is not None]

    def _hunks(self) -> list[Hunk]:
        """Return what was changed, and every draft."""
        visible = [k for k, item in enumerate(self._items) if item.text is not None]
        old = [item.text for item in self._shown()]
        found: list[list[int]] = []  # among what is visible: first, last; among lines: first, last
        line_of: dict[int, int] = {}
        matcher = SequenceMatcher(None, old, self.text, autojunk=False)
        for tag, i1, i2, j1, j2 in matcher.get_opcodes():
            is_equal = tag == "equal"
            if not is_equal:
                found.append([i1, i2, j1, j2])
            for i in range(i1, i2 + 1):
                line_of.setdefault(i, j1 + (i - i1) * is_equal)
            for i in range(i1, i2) if is_equal else ():
                if self._items[visible[i]].draft is not None:
                    found.append([i, i + 1, j1 + i - i1, j1 + i - i1 + 1])
        for k, item in enumerate(self._items):  # drafts without a line
            if item.text is None:
                i = sum(v < k for v in visible)
                j = line_of.get(i, len(self.text))
                found.append([i, i, j, j])
        merged: list[list[int]] = []
        for i1, i2, j1, j2 in sorted(found):
            if merged and i1 <= merged[-1][1] and j1 <= merged[-1][3]:
                merged[-1][1], merged[-1][3] = max(merged[-1][1], i2), max(merged[-1][3], j2)
            else:
                merged.append([i1, i2, j1, j2])
        bounds = [*visible, len(self._items)]
        hunks: list[Hunk] = []
        hidden: set[Key] = set()
        for hunk in merged:
            for i1, i2, j1, j2 in self._around_caret(*hunk):
                items = self._items_between(bounds[i1], bounds[i2])
                covers = [key for key in dict.fromkeys(_covers(items)) if key not in hidden]
                hidden.update(covers)
                hunks.append(Hunk(items, tuple(covers), j1, j2))
        return hunks

    def _around_caret(self, i1: int, i2: int, j1: int, j2: int) -> list[tuple[int, int, int, int]]:
        """Return the parts of a hunk before a hot line, of that, and behind it: what is finished in
        the lines around goes on without it. A draft stays whole: nobody knows which of its lines
        hide which."""
        k = self.caret
        if not self.is_hot or not j1 <= k < j2:
            return [(i1, i2, j1, j2)]
        first = min(i2, i1 + k - j1)
        last = max(first, i2 - (j2 - k - 1))
        shown = self._shown()
        for i in (first, last):
            if i1 < i < i2 and shown[i].draft and shown[i].draft is shown[i - 1].draft:
                return [(i1, i2, j1, j2)]
        parts = [(i1, first, j1, k), (first, last, k, k + 1), (last, i2, k + 1, j2)]
        return [part for part in parts if part[0] < part[1] or part[2] < part[3]]

    def _items_between(self, first: int, last: int) -> list[Item]:
        """Return these items, and those without a line that are right before them."""
        while first and self._items[first - 1].text is None:
            first -= 1
        return self._items[first:last]

    def _waits(self, hunk: Hunk) -> bool:
        """Whether it is a draft that stays, as it was."""
        rows = self.text[hunk.first : hunk.last]
        return (
            bool(hunk.items)
            and all(item.draft and item.draft.stays for item in hunk.items)
            and [item.text for item in hunk.items] == rows
        )

    def _splits(self, hunks: list[Hunk], held: list[Hunk]) -> bool:
        """Whether a row that is hidden by what is held is put in elsewhere: it would be there twice
        if the draft was given up."""
        hidden = {key for hunk in held for key in hunk.covers}
        rows = {line.text.strip() for line in lines(self.view) if hidden.intersection(line.keys)}
        rows |= {row.rstrip(";") for row in rows}
        return any(self.text[k].strip() in rows for hunk in hunks if hunk not in held
                   for k in range(hunk.first, hunk.last) if self.text[k].strip())  # fmt: skip

    def _drafts(self, held: list[Hunk]) -> list[Draft]:
        """Return what is held as drafts, each behind the line above it, which may be a new one."""
        keys = [key for line in lines(self.view) for key in line.keys]
        found = []
        for k, hunk in enumerate(held):
            rows = self.text[hunk.first : hunk.last]
            before = pieces_of(scan(self._text_without(held[:k], hunk.first)))
            above = keys[min(len(before), len(keys)) - 1] if before and keys else None
            found.append(Draft(rows, hunk.covers, above, self._waits(hunk)))
        return found

    def _text_without(self, held: list[Hunk], end: int | None = None) -> str:
        """Return the text, up to a line, with the lines of the program in the place of what is
        held."""
        found, at = [], 0
        for hunk in held:
            found += self.text[at : hunk.first]
            found += [line.text for line in self._covered(hunk)]
            at = hunk.last
        return "\n".join([*found, *self.text[at:end]])

    def _owners_without(self, held: list[Hunk]) -> list[str]:
        """Return whose each line of that text is."""
        assert self._owners is not None
        found, at = [], 0
        for hunk in held:
            found += self._owners[at : hunk.first]
            found += [line.keys[-1][0] for line in self._covered(hunk)]
            at = hunk.last
        return [*found, *self._owners[at:]]

    def _covered(self, hunk: Hunk) -> list[Line]:
        """Return the lines of the program whose place a hunk takes."""
        covers = set(hunk.covers)
        return [line for line in lines(self.view)
                if line.keys and covers.issuperset(line.keys)]  # fmt: skip

    def _revive(self, hunks: Iterable[Hunk]) -> None:
        """A line that was finished in the place of one that somebody has deleted is that one."""
        for hunk in hunks:
            rows = [row for row in self.text[hunk.first : hunk.last] if row.strip()]
            gone = [id for id, role in hunk.covers if role == OWN and id not in self.view]
            if len(rows) != 1 or not gone:
                continue
            try:
                made = read(rows[0])
            except Unparsed:
                continue
            for id in made[ROOT].inside:
                if id != START:
                    self._lately.setdefault(made[id].text, []).append(gone[0])

    # -- what arrives -----------------------------------------------------------------------------

    def receive(self, news: Json) -> None:
        """Take what the computer tells. What was typed meanwhile is made a change or a draft first.

        Raises Refused, KeyError or TypeError where it is no news.
        """
        rows = [taken_of(row) for row in news.get("changes", ())]
        is_whole = "whole" in news and (
            self.is_astray or news["epoch"] != self.epoch or news["n"] > self.number
        )
        is_new = is_whole or any(row.number > self.number for row in rows)
        last = int(news["last"])
        if not is_new and not any(page_and_count(each.uid)[1] <= last for each in self.pending):
            self._compare(news)
            return
        self.flush()
        if is_whole:
            self.base = tree_of(news["whole"])
            self.number, self.epoch = int(news["n"]), str(news["epoch"])
        for row in rows:
            if row.number <= self.number:
                continue
            if row.number != self.number + 1:
                break
            taken = applied(self.base, Change(row.uid, row.operations), is_sure=True)
            self.base, self.number = taken.tree, row.number
            if page_and_count(row.uid)[0] == self.name:
                undo = Undo(taken.back, conditions(self.base, taken.back))
                if row.uid in self._undoing:
                    self._redos = [*self._redos, undo][-MOST_UNDONE:]
                    continue
                self._undos = [*self._undos, undo][-MOST_UNDONE:]
                if row.uid not in self._redoing:
                    self._redos.clear()
        self._compare(news)
        refused = self._decide(news)
        self._rebase()
        self._keep_typed(refused)
        self._show(self.caret)

    def _compare(self, news: Json) -> None:
        """Look whether the tree is the computer's; of news that come late nothing is known."""
        newest = int(news["n"])
        if newest >= self.number:
            self.is_astray = newest > self.number or self.base.checksum() != news["sum"]

    def _decide(self, news: Json) -> list[Change]:
        """Forget what is decided; return what was refused."""
        why = {str(uid): str(reason) for uid, reason in news["refused"]}
        has = {str(row["uid"]) for row in news.get("changes", ())}
        last = int(news["last"])
        refused, pending = [], []
        for change in self.pending:
            is_decided = page_and_count(change.uid)[1] <= last
            if is_decided and change.uid in why:
                self.told.append((change.uid, why[change.uid]))
                refused.append(change)
                self._uncut |= {id for each in change.operations if isinstance(each, Delete)
                                for id in each.ids}  # fmt: skip
            elif not is_decided or not ("whole" in news or change.uid in has):
                pending.append(change)
        self.pending = pending
        return refused

    def _keep_typed(self, refused: list[Change]) -> None:
        """What was typed into an instruction that somebody has deleted is not lost: a draft."""
        for change in refused:
            [first, *more] = change.operations
            if more or not isinstance(first, Replace) or change.uid in self._undoing:
                continue
            text = dict(first.fields).get(TEXT, "")
            if text and first.id in self.base.gone and kind_of(text) == DO:
                own = (first.id, OWN)
                self.drafts.append(Draft([text], (own,), own, True))

    def _rebase(self) -> None:
        self.view = self.base
        for change in self.pending:
            with suppress(Refused):  # the computer says the same, soon
                self.view = applied(self.view, change).tree

    # -- what is shown ----------------------------------------------------------------------------

    def _show(self, caret: int | None = None, at: tuple[Draft, int] | None = None) -> None:
        """Lay the lines of the program and of the drafts out anew; the caret stays in its line,
        which may be `at` a line of a draft."""
        stays_at: tuple[Any, int] | None = at
        if at is None and caret is not None:
            stays_at = self._caret_item(caret)
        program = lines(self.view)
        present = {key for line in program for key in line.keys}
        hidden = {key for draft in self.drafts for key in draft.covers}
        behind: dict[Key | None, list[Draft]] = {}
        for draft in self.drafts:
            there = [key for key in draft.covers if key in present]
            anchor = there[0] if there else self._anchor(draft.above, present)
            behind.setdefault(anchor, []).append(draft)
        items: list[Item] = []

        def put(keys: Iterable[Key | None]) -> None:
            for key in keys:
                for draft in behind.pop(key, ()):
                    rows: list[str | None] = [*draft.rows] or [None]
                    items.extend(Item(row, (), draft) for row in rows)

        put([None])
        for line in program:
            if not line.keys or not hidden.issuperset(line.keys):
                items.append(Item(line.text, line.keys))
            put(line.keys)
        put(list(behind))
        self._items = items
        shown = self._shown()
        self.text = [item.text or "" for item in shown]
        self.caret = min(caret or 0, max(0, len(self.text) - 1))
        if stays_at is not None:
            what, k = stays_at
            found = [i for i, item in enumerate(shown) if what in (item.draft, item.keys)]
            self.caret = found[0] + k if found else self.caret

    def _caret_item(self, caret: int) -> tuple[Any, int] | None:
        """Return the draft that has the line of the caret, and which of its lines; or its keys."""
        shown = self._shown()
        if not 0 <= caret < len(shown):
            return None
        draft = shown[caret].draft
        if draft is not None:
            return draft, sum(item.draft is draft for item in shown[:caret])
        return (shown[caret].keys, 0) if shown[caret].keys else None

    def ids_of_lines(self) -> list[str]:
        """Return whose each line is that is shown: the id of an instruction, or nothing."""
        found = []
        for item in self._shown():
            covers = item.draft.covers if item.draft else item.keys
            found.append(covers[-1][0] if covers else "")
        return found

    def _anchor(self, above: Key | None, present: set[Key]) -> Key | None:
        """Return the line behind which a draft is whose line above has gone."""
        if above is None or above in present:
            return above
        id = above[0]
        for _ in range(MOST_STEPS):
            if id not in self.view.gone:
                break
            container, behind, _ = self.view.gone[id]
            id = behind or container
            for key in ((id, OF_END), (id, OWN)) if behind else ((id, OWN),):
                if key in present:
                    return key
        return None


def _covers(items: list[Item]) -> Iterator[Key]:
    """Return whose lines these are, or take the place of."""
    for item in items:
        yield from item.draft.covers if item.draft else item.keys


def _key(found: Any) -> Key:
    id, role = found
    return str(id), str(role)
