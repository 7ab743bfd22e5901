"""A pupil's page of a shared program: the visible lines, and the effect of typing.

It applies its own changes at once, over what has arrived; what is refused is not there any more. A
line that does not parse yet, or in which a key was just pressed, is a draft: text in the place of
lines, or after one. Only lines without drafts become operations, so no characters of two pupils
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
from tiniscript.together.differences import Clipboard
from tiniscript.together.form import (
    IS_GONE,
    MAX_OPERATIONS,
    Change,
    Condition,
    Delete,
    Operation,
    Refused,
    Replace,
    change_of,
    data_of_change,
    page_and_count,
    taken_change_of,
    tree_of,
)
from tiniscript.together.layout import (
    END_LINE,
    OWN_LINE,
    Key,
    Line,
    Unparsed,
    mistaken_lines,
    parse_tree,
    tree_lines,
)
from tiniscript.together.operations import apply_change, conditions_hold, inverse_conditions
from tiniscript.together.tree import INSTRUCTION, ROOT, START, TEXT, Json, Tree, kind_of

MAX_UNDONE = 200  # own changes that can be taken back
MAX_STEPS = 1000  # most steps from a removed node to an existing one


@dataclass(eq=False)
class Draft:
    """`rows` that replace the lines of `covered_keys`, or follow that of `key_above`.

    `stays`: it waits until its pupil continues it: another pupil has deleted the instruction, or
    the page was reloaded.
    """

    rows: list[str]
    covered_keys: tuple[Key, ...]
    key_above: Key | None
    stays: bool = False


@dataclass(eq=False)
class ShownLine:
    """A line as it is shown: of the program (`keys`), or of a draft, which may have none."""

    text: str | None
    keys: tuple[Key, ...] = ()
    draft: Draft | None = None


@dataclass(eq=False)
class Hunk:
    """Lines that those from `first_line` to `end_line`, not included, take the place of, and which
    these hide: no line is hidden by two."""

    shown_lines: list[ShownLine]
    covered_keys: tuple[Key, ...]
    first_line: int
    end_line: int


@dataclass(eq=False)
class Undo:
    operations: tuple[Operation, ...]
    conditions: tuple[Condition, ...]


@dataclass(eq=False)
class Page:
    """`base` is what the class's computer has told, `view` that with the own `pending_changes`."""

    name: str
    base: Tree = field(default_factory=Tree)
    number: int = 0
    epoch: str = ""
    lines: list[str] = field(default_factory=list)
    caret: int = 0
    is_line_edited: bool = False  # whether the caret's line was edited since the caret entered it
    pending_changes: list[Change] = field(default_factory=list)
    drafts: list[Draft] = field(default_factory=list)
    # Id of each refused change, and the reason.
    refusals: list[tuple[str, str]] = field(default_factory=list)
    change_count: int = 0  # number of own changes
    id_count: int = 0
    # Whether its tree differs from the computer's, so that it needs a full copy.
    is_out_of_sync: bool = False

    def __post_init__(self) -> None:
        self.view = self.base
        self._undos: list[Undo] = []
        self._undo_uids: set[str] = set()  # uids of changes that undo something
        self._cut_ids_by_text: dict[str, list[str]] = {}
        self._restored_ids: set[str] = set()  # nodes restored because their deletion was refused
        self._shown_lines: list[ShownLine] = []
        self._redos: list[Undo] = []
        self._redo_uids: set[str] = set()
        # Owners of the text's lines, as the blocks define them.
        self._owners: list[str] | None = None
        self._show()

    def copy(self) -> Page:
        """Return an independent copy."""
        copied_page = Page(
            self.name,
            self.base,
            self.number,
            self.epoch,
            self.lines[:],
            self.caret,
            self.is_line_edited,
            self.pending_changes[:],
            self.drafts[:],
            self.refusals[:],
            self.change_count,
            self.id_count,
            self.is_out_of_sync,
        )
        copied_page.view, copied_page.lines, copied_page.caret, copied_page._shown_lines = (
            self.view,
            self.lines,
            self.caret,
            self._shown_lines,
        )
        copied_page._undos, copied_page._undo_uids, copied_page._restored_ids = (
            self._undos[:],
            {*self._undo_uids},
            {*self._restored_ids},
        )
        copied_page._redos, copied_page._redo_uids = self._redos[:], {*self._redo_uids}
        copied_page._cut_ids_by_text = {text: ids[:] for text, ids in self._cut_ids_by_text.items()}
        return copied_page

    # -- the storage of the browser: a reload continues from it ------------------------------------

    def store_data(self) -> Json:
        return {
            "name": self.name,
            "count": self.change_count,
            "ids": self.id_count,
            "pending": [data_of_change(change) for change in self.pending_changes],
            "undoing": sorted(self._undo_uids),
            "drafts": [
                [change.rows, change.covered_keys, change.key_above] for change in self.drafts
            ],
            "row": self.lines[self.caret] if self.lines else "",
        }

    @classmethod
    def of(cls, name: str, news: Json, store: Json | None = None) -> Page:
        """Return a page with the whole program; a reloaded page gets its stored data, whatever its
        name was: a draft stays until its pupil continues it.

        Raises Refused, and what a damaged store raises: KeyError, TypeError, ValueError.
        """
        page = cls(name, tree_of(news["whole"]), news["n"], news["epoch"])
        refused_changes: list[Change] = []
        if store is not None:
            page.pending_changes = list(map(change_of, store["pending"]))
            if store["name"] == name:
                page.change_count, page.id_count = int(store["count"]), int(store["ids"])
                page._undo_uids = set(store["undoing"])
            else:  # existing nodes are not inserted again
                page.pending_changes = [change._replace(uid=f"{name}:{k}")
                                for k, change in enumerate(page.pending_changes, 1)]  # fmt: skip
                page.change_count = len(page.pending_changes)
            page.drafts = [
                Draft(
                    list(rows),
                    tuple(map(_key, covered_keys)),
                    _key(key_above) if key_above else None,
                    True,
                )
                for rows, covered_keys, key_above in store["drafts"]
                if rows  # rows that were only removed are back
            ]
            refused_changes = page._decide(news)
        page._rebase()
        page._keep_refused_text(refused_changes)
        page._show()
        if store is not None and store["row"] in page.lines:
            page.caret = page.lines.index(store["row"])
        return page

    # -- own changes ------------------------------------------------------------------------------

    def new_id(self) -> str:
        self.id_count += 1
        return f"{self.name}.{self.id_count}"

    def apply(self, operations: Iterable[Operation], undo: Undo | None = None) -> bool:
        """Apply own operations at once; impossible ones are not sent."""
        made_operations = tuple(operations)
        change = Change(
            f"{self.name}:{self.change_count + 1}",
            made_operations,
            undo.conditions if undo else (),
            self.number,
        )
        if not made_operations or len(made_operations) > MAX_OPERATIONS:
            return False
        try:
            result = apply_change(self.view, change)
        except Refused:
            return False
        old_view, self.view = self.view, result.tree
        for operation in made_operations:
            for id in operation.ids if isinstance(operation, Delete) else ():
                if id in old_view:
                    self._cut_ids_by_text.setdefault(old_view[id].text, []).append(id)
        self.change_count += 1
        self.pending_changes.append(change)
        return True

    def write(self, lines: list[str], owners: list[str]) -> None:
        """Replace the text by that of the blocks; `owners` names the owner of each line."""
        self.type(lines, self.caret)
        self._owners = owners
        self.leave()
        self._owners = None

    def catch_up(self, other: Page, ancestor: Page) -> None:
        """Do what another page has done since it was a copy of `ancestor`."""
        self.id_count = other.id_count
        lost_changes = [change for change in other.pending_changes[len(ancestor.pending_changes) :]
                if not self.apply(change.operations)]  # fmt: skip
        old_drafts = [(draft.rows, draft.covered_keys) for draft in ancestor.drafts]
        own_drafts = [
            draft for draft in self.drafts if (draft.rows, draft.covered_keys) not in old_drafts
        ]
        self.drafts = [*other.drafts, *own_drafts]
        self._keep_refused_text(lost_changes)
        self.refusals += [(change.uid, IS_GONE) for change in lost_changes]
        self._show(self.caret)

    def undo(self) -> bool:
        """Take back the newest own change that nobody has changed since."""
        return self._take_back(self._undos, self._undo_uids)

    def redo(self) -> bool:
        """Take back the newest undo, if no own change came after it."""
        return self._take_back(self._redos, self._redo_uids)

    def _take_back(self, undos: list[Undo], uids: set[str]) -> bool:
        self.leave()
        for undo in reversed(undos):
            if conditions_hold(self.view, undo.conditions) and self.apply(undo.operations, undo):
                undos.remove(undo)
                uids.add(self.pending_changes[-1].uid)
                self._show(self.caret)
                return True
        return False

    # -- typing -----------------------------------------------------------------------------------

    def type(self, lines: list[str], caret: int, is_line_edited: bool = False) -> None:
        """The editor has this text now. Nothing happens with it before `flush`."""
        self.lines, self.is_line_edited = lines, is_line_edited
        self.caret = min(caret, max(0, len(lines) - 1))

    def leave(self) -> None:
        """The caret has left its line: by Enter, an arrow, a press elsewhere, or the run button."""
        self.is_line_edited = False
        self.flush()

    def flush(self) -> None:
        """Turn finished text into operations, and the rest, and a hot line, into drafts."""
        if (
            self.lines == [shown_line.text for shown_line in self._visible_lines()]
            and not self.drafts
        ):
            return
        hunks = self._hunks()
        if not hunks:
            return
        bad_lines = mistaken_lines("\n".join(self.lines))
        if self.is_line_edited:
            bad_lines |= {self.caret}
        bad_hunks = [
            hunk for hunk in hunks if any(hunk.first_line <= k < hunk.end_line for k in bad_lines)
        ]
        held_hunks = [hunk for hunk in hunks if hunk in bad_hunks or self._waits(hunk)]
        if (bad_lines and not bad_hunks) or self._splits(hunks, held_hunks):
            held_hunks = hunks
        for draft_hunks in (held_hunks, hunks):
            if self._make_changes(hunks, draft_hunks):
                self.drafts = self._drafts_of(draft_hunks)
                caret_drafts = [(draft, self.caret - hunk.first_line)
                      for draft, hunk in zip(self.drafts, draft_hunks, strict=True)
                      if hunk.first_line <= self.caret < hunk.end_line]  # fmt: skip
                self._show(self.caret, caret_drafts[0] if caret_drafts else None)
                return
        self._show(self.caret)

    def give_up(self) -> None:
        """Take out what does not parse."""
        self.flush()
        self.is_line_edited = False
        self.drafts = []
        self._show()

    def _make_changes(self, hunks: list[Hunk], held_hunks: list[Hunk]) -> bool:
        """Turn everything except held parts into changes; return whether that was possible."""
        try:
            self._revive(hunk for hunk in hunks if hunk not in held_hunks)
            operations = differences.find_operations(
                self.view,
                self._text_without(held_hunks),
                self.new_id,
                Clipboard(self._cut_ids_by_text, self._restored_ids),
                self._owners and self._owners_without(held_hunks),
            )
        except (Unparsed, Refused):
            return False
        # New values are changes of their own: a refused one does not affect the others.
        shape_operations = [
            operation for operation in operations if not isinstance(operation, Replace)
        ]
        if shape_operations and not self.apply(shape_operations):
            return False
        for operation in operations:
            if isinstance(operation, Replace):
                self.apply([operation])
        return True

    def _visible_lines(self) -> list[ShownLine]:
        return [item for item in self._shown_lines if item.text is not None]

    def _hunks(self) -> list[Hunk]:
        """Return the changed parts, and every draft."""
        visible_indexes = [k for k, item in enumerate(self._shown_lines) if item.text is not None]
        old_lines = [item.text for item in self._visible_lines()]
        ranges: list[list[int]] = []  # first and last visible one; first and last line
        line_of: dict[int, int] = {}
        matcher = SequenceMatcher(None, old_lines, self.lines, autojunk=False)
        for tag, i1, i2, j1, j2 in matcher.get_opcodes():
            is_equal = tag == "equal"
            if not is_equal:
                ranges.append([i1, i2, j1, j2])
            for i in range(i1, i2 + 1):
                line_of.setdefault(i, j1 + (i - i1) * is_equal)
            for i in range(i1, i2) if is_equal else ():
                if self._shown_lines[visible_indexes[i]].draft is not None:
                    ranges.append([i, i + 1, j1 + i - i1, j1 + i - i1 + 1])
        for k, item in enumerate(self._shown_lines):  # drafts without a line
            if item.text is None:
                i = sum(v < k for v in visible_indexes)
                j = line_of.get(i, len(self.lines))
                ranges.append([i, i, j, j])
        merged_ranges: list[list[int]] = []
        for i1, i2, j1, j2 in sorted(ranges):
            if merged_ranges and i1 <= merged_ranges[-1][1] and j1 <= merged_ranges[-1][3]:
                merged_ranges[-1][1] = max(merged_ranges[-1][1], i2)
                merged_ranges[-1][3] = max(merged_ranges[-1][3], j2)
            else:
                merged_ranges.append([i1, i2, j1, j2])
        bounds = [*visible_indexes, len(self._shown_lines)]
        hunks: list[Hunk] = []
        hidden_keys: set[Key] = set()
        for range_bounds in merged_ranges:
            for i1, i2, j1, j2 in self._split_at_caret(*range_bounds):
                shown_lines = self._shown_lines_between(bounds[i1], bounds[i2])
                covered_keys = [
                    key
                    for key in dict.fromkeys(_covered_keys(shown_lines))
                    if key not in hidden_keys
                ]
                hidden_keys.update(covered_keys)
                hunks.append(Hunk(shown_lines, tuple(covered_keys), j1, j2))
        return hunks

    def _split_at_caret(
        self, i1: int, i2: int, j1: int, j2: int
    ) -> list[tuple[int, int, int, int]]:
        """Return the parts of a hunk before a hot line, the line, and those after it, so that
        finished lines are sent without it. A draft stays whole, because it is unknown which of its
        lines hide which.
        """
        k = self.caret
        if not self.is_line_edited or not j1 <= k < j2:
            return [(i1, i2, j1, j2)]
        edited_start = min(i2, i1 + k - j1)
        edited_end = max(edited_start, i2 - (j2 - k - 1))
        visible_lines = self._visible_lines()
        for i in (edited_start, edited_end):
            if (
                i1 < i < i2
                and visible_lines[i].draft
                and visible_lines[i].draft is visible_lines[i - 1].draft
            ):
                return [(i1, i2, j1, j2)]
        parts = [
            (i1, edited_start, j1, k),
            (edited_start, edited_end, k, k + 1),
            (edited_end, i2, k + 1, j2),
        ]
        return [part for part in parts if part[0] < part[1] or part[2] < part[3]]

    def _shown_lines_between(self, first_line: int, last_line: int) -> list[ShownLine]:
        """Return these items, and those without a line that are right before them."""
        while first_line and self._shown_lines[first_line - 1].text is None:
            first_line -= 1
        return self._shown_lines[first_line:last_line]

    def _waits(self, hunk: Hunk) -> bool:
        """Return whether it is an unchanged draft."""
        rows = self.lines[hunk.first_line : hunk.end_line]
        return (
            bool(hunk.shown_lines)
            and all(item.draft and item.draft.stays for item in hunk.shown_lines)
            and [item.text for item in hunk.shown_lines] == rows
        )

    def _splits(self, hunks: list[Hunk], held_hunks: list[Hunk]) -> bool:
        """Return whether a row hidden by a held draft is inserted elsewhere, so that giving up the
        draft would double it.
        """
        hidden_keys = {key for hunk in held_hunks for key in hunk.covered_keys}
        rows = {
            line.text.strip()
            for line in tree_lines(self.view)
            if hidden_keys.intersection(line.keys)
        }
        rows |= {row.rstrip(";") for row in rows}
        return any(
            self.lines[k].strip() in rows
            for hunk in hunks
            if hunk not in held_hunks
            for k in range(hunk.first_line, hunk.end_line)
            if self.lines[k].strip()
        )

    def _drafts_of(self, held_hunks: list[Hunk]) -> list[Draft]:
        """Return the held parts as drafts, each after the line above it, which may be new."""
        keys = [key for line in tree_lines(self.view) for key in line.keys]
        drafts = []
        for k, hunk in enumerate(held_hunks):
            rows = self.lines[hunk.first_line : hunk.end_line]
            pieces_above = pieces_of(scan(self._text_without(held_hunks[:k], hunk.first_line)))
            key_above = (
                keys[min(len(pieces_above), len(keys)) - 1] if pieces_above and keys else None
            )
            drafts.append(Draft(rows, hunk.covered_keys, key_above, self._waits(hunk)))
        return drafts

    def _text_without(self, held_hunks: list[Hunk], end: int | None = None) -> str:
        """Return the text up to a line, with the program's lines instead of held parts."""
        lines, line_index = [], 0
        for hunk in held_hunks:
            lines += self.lines[line_index : hunk.first_line]
            lines += [line.text for line in self._covered_lines(hunk)]
            line_index = hunk.end_line
        return "\n".join([*lines, *self.lines[line_index:end]])

    def _owners_without(self, held_hunks: list[Hunk]) -> list[str]:
        """Return the owner of each line of that text."""
        assert self._owners is not None
        owners, line_index = [], 0
        for hunk in held_hunks:
            owners += self._owners[line_index : hunk.first_line]
            owners += [line.keys[-1][0] for line in self._covered_lines(hunk)]
            line_index = hunk.end_line
        return [*owners, *self._owners[line_index:]]

    def _covered_lines(self, hunk: Hunk) -> list[Line]:
        """Return the lines of the program whose place a hunk takes."""
        covered_keys = set(hunk.covered_keys)
        return [line for line in tree_lines(self.view)
                if line.keys and covered_keys.issuperset(line.keys)]  # fmt: skip

    def _revive(self, hunks: Iterable[Hunk]) -> None:
        """Give a finished line the id of the deleted line that it replaces."""
        for hunk in hunks:
            rows = [row for row in self.lines[hunk.first_line : hunk.end_line] if row.strip()]
            gone_ids = [
                id for id, role in hunk.covered_keys if role == OWN_LINE and id not in self.view
            ]
            if len(rows) != 1 or not gone_ids:
                continue
            try:
                tree = parse_tree(rows[0])
            except Unparsed:
                continue
            for id in tree[ROOT].children:
                if id != START:
                    self._cut_ids_by_text.setdefault(tree[id].text, []).append(gone_ids[0])

    # -- what arrives -----------------------------------------------------------------------------

    def receive(self, news: Json) -> None:
        """Take what the computer tells. Text typed meanwhile first becomes a change or a draft.

        Raises Refused, KeyError or TypeError if it is no news.
        """
        taken_changes = [taken_change_of(taken_change) for taken_change in news.get("changes", ())]
        is_whole = "whole" in news and (
            self.is_out_of_sync or news["epoch"] != self.epoch or news["n"] > self.number
        )
        is_new = is_whole or any(
            taken_change.number > self.number for taken_change in taken_changes
        )
        last_count = int(news["last"])
        if not is_new and not any(
            page_and_count(change.uid)[1] <= last_count for change in self.pending_changes
        ):
            self._compare(news)
            return
        self.flush()
        if is_whole:
            self.base = tree_of(news["whole"])
            self.number, self.epoch = int(news["n"]), str(news["epoch"])
        for taken_change in taken_changes:
            if taken_change.number <= self.number:
                continue
            if taken_change.number != self.number + 1:
                break
            result = apply_change(
                self.base, Change(taken_change.uid, taken_change.operations), is_sure=True
            )
            self.base, self.number = result.tree, taken_change.number
            if page_and_count(taken_change.uid)[0] == self.name:
                undo = Undo(result.inverse, inverse_conditions(self.base, result.inverse))
                if taken_change.uid in self._undo_uids:
                    self._redos = [*self._redos, undo][-MAX_UNDONE:]
                    continue
                self._undos = [*self._undos, undo][-MAX_UNDONE:]
                if taken_change.uid not in self._redo_uids:
                    self._redos.clear()
        self._compare(news)
        refused_changes = self._decide(news)
        self._rebase()
        self._keep_refused_text(refused_changes)
        self._show(self.caret)

    def _compare(self, news: Json) -> None:
        """Look whether the tree is the computer's; of news that come late nothing is known."""
        newest_number = int(news["n"])
        if newest_number >= self.number:
            self.is_out_of_sync = newest_number > self.number or self.base.checksum() != news["sum"]

    def _decide(self, news: Json) -> list[Change]:
        """Forget the decided changes; return the refused ones."""
        reason_of_uid = {str(uid): str(reason) for uid, reason in news["refused"]}
        taken_uids = {str(row["uid"]) for row in news.get("changes", ())}
        last_count = int(news["last"])
        refused_changes, pending_changes = [], []
        for change in self.pending_changes:
            is_decided = page_and_count(change.uid)[1] <= last_count
            if is_decided and change.uid in reason_of_uid:
                self.refusals.append((change.uid, reason_of_uid[change.uid]))
                refused_changes.append(change)
                self._restored_ids |= {
                    id
                    for operation in change.operations
                    if isinstance(operation, Delete)
                    for id in operation.ids
                }
            elif not is_decided or not ("whole" in news or change.uid in taken_uids):
                pending_changes.append(change)
        self.pending_changes = pending_changes
        return refused_changes

    def _keep_refused_text(self, refused_changes: list[Change]) -> None:
        """Turn text typed into an instruction deleted by others into a draft."""
        for change in refused_changes:
            [operation, *other_operations] = change.operations
            if (
                other_operations
                or not isinstance(operation, Replace)
                or change.uid in self._undo_uids
            ):
                continue
            text = dict(operation.fields).get(TEXT, "")
            if (
                text
                and operation.id in self.base.former_place_by_id
                and kind_of(text) == INSTRUCTION
            ):
                own_key = (operation.id, OWN_LINE)
                self.drafts.append(Draft([text], (own_key,), own_key, True))

    def _rebase(self) -> None:
        self.view = self.base
        for change in self.pending_changes:
            with suppress(Refused):  # the computer soon confirms this
                self.view = apply_change(self.view, change).tree

    # -- what is shown ----------------------------------------------------------------------------

    def _show(self, caret: int | None = None, caret_draft: tuple[Draft, int] | None = None) -> None:
        """Lay the lines of the program and of the drafts out anew; the caret stays in its line,
        which may be that of a draft, `caret_draft`."""
        caret_target: tuple[Any, int] | None = caret_draft
        if caret_draft is None and caret is not None:
            caret_target = self._caret_target(caret)
        program_lines = tree_lines(self.view)
        present_keys = {key for line in program_lines for key in line.keys}
        hidden_keys = {key for draft in self.drafts for key in draft.covered_keys}
        drafts_behind: dict[Key | None, list[Draft]] = {}
        for draft in self.drafts:
            present_covers = [key for key in draft.covered_keys if key in present_keys]
            anchor = (
                present_covers[0] if present_covers else self._anchor(draft.key_above, present_keys)
            )
            drafts_behind.setdefault(anchor, []).append(draft)
        shown_lines: list[ShownLine] = []

        def put_drafts(keys: Iterable[Key | None]) -> None:
            for key in keys:
                for draft in drafts_behind.pop(key, ()):
                    rows: list[str | None] = [*draft.rows] or [None]
                    shown_lines.extend(ShownLine(row, (), draft) for row in rows)

        put_drafts([None])
        for line in program_lines:
            if not line.keys or not hidden_keys.issuperset(line.keys):
                shown_lines.append(ShownLine(line.text, line.keys))
            put_drafts(line.keys)
        put_drafts(list(drafts_behind))
        self._shown_lines = shown_lines
        visible_lines = self._visible_lines()
        self.lines = [item.text or "" for item in visible_lines]
        self.caret = min(caret or 0, max(0, len(self.lines) - 1))
        if caret_target is not None:
            target, k = caret_target
            indexes = [
                i for i, item in enumerate(visible_lines) if target in (item.draft, item.keys)
            ]
            self.caret = indexes[0] + k if indexes else self.caret

    def _caret_target(self, caret: int) -> tuple[Any, int] | None:
        """Return the draft that has the line of the caret, and which of its lines; or its keys."""
        visible_lines = self._visible_lines()
        if not 0 <= caret < len(visible_lines):
            return None
        draft = visible_lines[caret].draft
        if draft is not None:
            return draft, sum(item.draft is draft for item in visible_lines[:caret])
        return (visible_lines[caret].keys, 0) if visible_lines[caret].keys else None

    def ids_of_lines(self) -> list[str]:
        """Return the instruction id of each visible line, or ""."""
        ids = []
        for item in self._visible_lines():
            keys = item.draft.covered_keys if item.draft else item.keys
            ids.append(keys[-1][0] if keys else "")
        return ids

    def lines_of_drafts(self) -> list[int]:
        """Return the lines, from 1, that no other page has, but for blank ones."""
        lines = enumerate(self._visible_lines(), 1)
        return [number for number, item in lines if item.draft and (item.text or "").strip()]

    def _anchor(self, key_above: Key | None, present_keys: set[Key]) -> Key | None:
        """Return the line after which a draft is whose line above has gone."""
        if key_above is None or key_above in present_keys:
            return key_above
        id = key_above[0]
        for _ in range(MAX_STEPS):
            if id not in self.view.former_place_by_id:
                break
            container, previous_id, _ = self.view.former_place_by_id[id]
            id = previous_id or container
            for key in ((id, END_LINE), (id, OWN_LINE)) if previous_id else ((id, OWN_LINE),):
                if key in present_keys:
                    return key
        return None


def _covered_keys(shown_lines: list[ShownLine]) -> Iterator[Key]:
    """Yield the keys of these lines, including those of replaced lines."""
    for item in shown_lines:
        yield from item.draft.covered_keys if item.draft else item.keys


def _key(data: Any) -> Key:
    id, role = data
    return str(id), str(role)
