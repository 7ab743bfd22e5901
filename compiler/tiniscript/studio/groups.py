"""Groups of a class: up to four pupils who edit one program, each on a page of their own. The
teacher may take part, too: as one more page, which they see, and which has no part in their robot.

A page sends its changes, and where its caret is; it hears those of the others in a request that is
held until there are any. A pupil who spoils the program of a group does not affect other groups:
the amount that a pupil may send is limited, and each group has its own lock, so none waits for
another. Knows no HTTP, no robot and no page; `together` has the program.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path
from threading import Condition, Lock, RLock
from time import monotonic

from tiniscript.base.source import LINE_END
from tiniscript.studio.block_reading import split_loose
from tiniscript.studio.entrances import new_token
from tiniscript.studio.group_runs import GroupRuns
from tiniscript.studio.names import are_alike, plain_name
from tiniscript.studio.rates import Rate
from tiniscript.studio.robot_link import MAX_COUNT, BadRequest, Json, whole_number
from tiniscript.together.form import (
    BAD,
    TOO_LONG,
    Delete,
    Insert,
    Operation,
    Refused,
    Replace,
    TakenChange,
    Wrap,
    change_of,
    is_uid,
    page_and_count,
    tree_of,
)
from tiniscript.together.journal import Journal
from tiniscript.together.layout import Unparsed, parse_tree, text_of
from tiniscript.together.operations import MAX_CHARACTERS
from tiniscript.together.ordering import MAX_PAGES, SharedProgram
from tiniscript.together.tree import Tree

MAX_MEMBERS = 4
MAX_GROUPS = 30
MAX_FOUNDED = 3  # groups with a program, by one pupil
MAX_HELD_S = 8.0  # longest time that a request is held; slower connections are closed
POLL_INTERVAL_S = 0.2  # interval between two looks at the robot's events
ABSENCE_S = 20.0  # a page silent for longer loses its place
MAX_CHANGES = 50  # most changes in a request
CHANGE_BYTES = 64_000  # most bytes of a change as JSON; a whole program is smaller
BYTES_PER_COST = 2000  # a change costs one for each of these that it begins
# Burst and rate of a pupil's changes: fast pupils make one a second, and a large one takes 40 ms.
CHANGE_RATE = (80, 4)
MARK_COUNT = 4  # colours of pupils; the next one is the teacher's
TEACHER = "teacher"  # no pupil has this token
MAX_HISTORY_LINES = 200  # changes that the teacher's page shows
_NODE_ID = re.compile(r"[a-z0-9.]{0,24}")
_PAGE_NAME = re.compile(r"m[0-9]{1,6}")

Clock = Callable[[], float]


@dataclass(eq=False)
class Member:
    """`page` is the name of the page in the program; `node_id`: the instruction with the caret,
    which the pupil `writes` or has only chosen. `hold_count` counts requests: one is held."""

    token: str
    name: str
    page: str
    heard_s: float
    mark: int = 0
    node_id: str = ""
    writes: bool = False
    hold_count: int = 0
    stop_count: int = 0


@dataclass(eq=False)
class Group:
    """`version` counts changes besides the program: the members, and their carets.

    No two pages have the same name, in all its time: `owner_of_page` has the newest.
    """

    name: str
    founder: str
    program: SharedProgram
    journal: Journal
    key: str
    member_by_token: dict[str, Member] = field(default_factory=dict)  # keyed by token
    version: int = 0
    owner_of_page: dict[str, str] = field(default_factory=dict)  # tokens; the newest ones
    # Names of pupils, including those who have left.
    name_of_page: dict[str, str] = field(default_factory=dict)
    condition: Condition = field(default_factory=Condition)
    runs: GroupRuns = field(default_factory=GroupRuns)

    @property
    def text(self) -> str:
        return text_of(self.program.tree)

    @property
    def pupils(self) -> list[Member]:
        return [member for member in self.member_by_token.values() if member.token != TEACHER]


class Groups:
    """Any thread may call it. `folder` is for their journals; without one nothing is kept."""

    def __init__(self, clock: Clock = monotonic, folder: Path | None = None) -> None:
        self._clock = clock
        self._folder = folder
        self._lock = RLock()  # never used by the holder of a group's token
        self._group_by_key: dict[str, Group] = {}  # keyed by the group's key
        self._rate = Rate(*CHANGE_RATE)
        self._rate_lock = Lock()

    # -- pupils -----------------------------------------------------------------------------------

    def join(self, token: str, name: str, request: Json) -> Json:
        """A pupil joins the group of a name; if there is none, it begins with the pupil's own
        program. Raises BadRequest."""
        group_name, text, old_page = request.get("name"), request.get("text"), request.get("before")
        if not isinstance(group_name, str) or not isinstance(text, str):
            raise BadRequest
        typed_name = plain_name(group_name)
        if not typed_name:
            return {"failure": "group_nameless"}
        with self._lock:
            group = self._find_by_name(typed_name)
            if group is None:
                try:
                    group = self._create(token, typed_name, text)
                except Unparsed:
                    return {"failure": "group_mistakes"}
                except Refused:
                    return {"failure": "group_long"}
                if group is None:
                    return {"failure": "group_many"}
            own_group = self.group_of(token)
            if own_group is not None and own_group is not group:
                self.leave(token)
            return self._enter(group, token, name, old_page)

    def visit(self, request: Json) -> Json:
        """The teacher takes part in a group that there is. Raises BadRequest."""
        name = request.get("name")
        if not isinstance(name, str):
            raise BadRequest
        with self._lock:
            group, own_group = self.group_by_key(request.get("group")), self.group_of(TEACHER)
            if group is None:
                return {"failure": "group_gone"}
            if own_group is not None and own_group is not group:
                self.leave(TEACHER)
            return self._enter(group, TEACHER, plain_name(name), request.get("before"))

    def _find_by_name(self, name: str) -> Group | None:
        return next(
            (group for group in self._group_by_key.values() if are_alike(group.name, name)), None
        )

    def _create(self, token: str, name: str, text: str) -> Group | None:
        """Return a new group; None if there are too many. Raises Unparsed, Refused."""
        own_groups = [group for group in self._group_by_key.values() if group.founder == token]
        if len(self._group_by_key) >= MAX_GROUPS or len(own_groups) >= MAX_FOUNDED:
            return None
        return self._add_group(name, token, new_token(), _tree_of(text))

    def _add_group(self, name: str, founder: str, key: str, tree: Tree | None) -> Group | None:
        """Add a group with a program, or one that continues from its journal."""
        journal = Journal(self._folder / f"{key}.journal" if self._folder is not None else None)
        epoch = new_token()
        program = journal.begin(tree, epoch) if tree is not None else journal.resume(epoch)
        if program is None:
            return None
        group = self._group_by_key[key] = Group(name, founder, program, journal, key)
        return group

    def _enter(self, group: Group, token: str, name: str, old_page: object) -> Json:
        now_s = self._clock()
        with group.condition:
            member = group.member_by_token.get(token)
            if member is None:
                pupils = group.pupils
                if token != TEACHER and len(pupils) >= MAX_MEMBERS:
                    silent_member = min(pupils, key=lambda pupil: pupil.heard_s)
                    if now_s - silent_member.heard_s <= ABSENCE_S:
                        return {"failure": "group_full"}
                    del group.member_by_token[silent_member.token]
                taken_marks = {member.mark for member in group.member_by_token.values()}
                free_marks = (k for k in range(MARK_COUNT) if k not in taken_marks)
                mark = MARK_COUNT if token == TEACHER else next(free_marks)
                member = group.member_by_token[token] = Member(token, name, "", now_s, mark)
            if not isinstance(old_page, str) or group.owner_of_page.get(old_page) != token:
                old_page = (
                    f"m{1 + max((_page_number(page) for page in group.owner_of_page), default=0)}"
                )
                group.owner_of_page[old_page] = token
                for page in list(group.owner_of_page)[:-MAX_PAGES]:
                    del group.owner_of_page[page]
            member.page, member.heard_s, member.name = old_page, now_s, name
            member.stop_count = 0  # a page that was opened anew counts from 1
            group.name_of_page[old_page] = name
            _notify(group)
            return {"group": group.name, "page": member.page,
                    **group.program.news(member.page, -1, "")}  # fmt: skip

    def leave(self, token: str) -> None:
        """Remove the holder of a token from their group, if any. An unchanged program is deleted
        with its last pupil.
        """
        with self._lock:
            group = self.group_of(token)
            if group is None:
                return
            with group.condition:
                del group.member_by_token[token]
                is_over = not group.pupils and group.program.number == 0
                if is_over:
                    group.member_by_token.clear()
                _notify(group)
            if is_over:
                del self._group_by_key[group.key]
                group.journal.forget()

    def answer(self, token: str, request: Json) -> Json:
        """Apply changes, and return the news; if the page `waits`, once there is some.

        Raises BadRequest. Call this without any lock.
        """
        group = self.group_of(token)
        if group is None:
            return {"left": True}
        since_number = whole_number(request, "since", -1, MAX_COUNT)
        seen_version = whole_number(request, "saw", 0, MAX_COUNT, 0)
        epoch, changes = request.get("epoch"), request.get("changes", [])
        if not isinstance(epoch, str) or not isinstance(changes, list):
            raise BadRequest
        with group.condition:
            member = group.member_by_token.get(token)
            if member is None or member.page != request.get("page"):
                return {"left": True}
            member.heard_s = self._clock()
            self._drop_silent_teacher(group)
            is_slow = not self._decide(group, member, changes)
            self._update_caret(group, member, request)
            group.condition.notify_all()
            run_position = request.get("ran")
            if request.get("waits") is True and not changes:
                self._wait_for_news(group, member, since_number, seen_version, run_position)
            if group.member_by_token.get(token) is not member:
                return {"left": True}
            number, runs = group.runs.news_after(run_position, token)
            return {
                **group.program.news(member.page, since_number, epoch),
                "group": group.name,
                "saw": group.version,
                "others": [
                    _member_data(other)
                    for other in group.member_by_token.values()
                    if other is not member
                ],
                "ran": [group.runs.key, number],
                **({"runs": runs} if runs else {}),
                **({"slow": True} if is_slow else {}),
            }

    def _drop_silent_teacher(self, group: Group) -> None:
        """Remove a teacher whose page is silent; the page learns that when it returns."""
        teacher = group.member_by_token.get(TEACHER)
        if teacher is not None and self._clock() - teacher.heard_s > ABSENCE_S:
            del group.member_by_token[TEACHER]
            _notify(group)

    def _wait_for_news(
        self,
        group: Group,
        member: Member,
        since_number: int,
        seen_version: int,
        run_position: object,
    ) -> None:
        """Wait until there is something new, or the page asks again."""
        member.hold_count += 1
        hold_number = member.hold_count
        group.condition.notify_all()
        end_s = monotonic() + MAX_HELD_S
        while (
            (group.program.number, group.version, member.hold_count)
            == (since_number, seen_version, hold_number)
            and group.member_by_token.get(member.token) is member
            and not group.runs.news_after(run_position, member.token)[1]
            and (left_s := end_s - monotonic()) > 0
        ):  # a robot's thread, which must not wait, wakes nobody
            group.condition.wait(min(left_s, POLL_INTERVAL_S))

    def _decide(self, group: Group, member: Member, changes: list[object]) -> bool:
        """Decide on changes; return whether all of them were looked at. Raises BadRequest."""
        if len(changes) > MAX_CHANGES:
            raise BadRequest
        for row in changes:
            uid = row.get("uid") if isinstance(row, dict) else None
            if not isinstance(uid, str) or not is_uid(uid) or page_and_count(uid)[0] != member.page:
                raise BadRequest
            size = len(json.dumps(row, separators=(",", ":")))
            cost = 1 + min(size, CHANGE_BYTES) // BYTES_PER_COST
            with self._rate_lock:
                if not self._rate.take_amount(member.token, self._clock(), cost):
                    return False
            if size > CHANGE_BYTES:
                group.program.refuse(uid, TOO_LONG)
                continue
            try:
                change = change_of(row)
            except (Refused, RecursionError):
                group.program.refuse(uid, BAD)
                continue
            if group.program.submit([change]):
                group.condition.notify_all()
        return True

    def _update_caret(self, group: Group, member: Member, request: Json) -> None:
        node_id, writes = request.get("at", member.node_id), request.get("writes", member.writes)
        if (
            not isinstance(node_id, str)
            or not _NODE_ID.fullmatch(node_id)
            or not isinstance(writes, bool)
        ):
            raise BadRequest
        if (node_id, writes) != (member.node_id, member.writes):
            member.node_id, member.writes = node_id, writes
            _notify(group)

    # -- for the class ----------------------------------------------------------------------------

    def group_of(self, token: str) -> Group | None:
        with self._lock:
            return next(
                (group for group in self._group_by_key.values() if token in group.member_by_token),
                None,
            )

    def mate_tokens(self, token: str) -> list[str]:
        """Return the tokens of all who are in a pupil's group, the own one, too."""
        group = self.group_of(token)
        return [*group.member_by_token] if group is not None else [token]

    def runs_of(self, token: str) -> GroupRuns | None:
        """Return the runs of a pupil's group, if any."""
        group = self.group_of(token)
        return group.runs if group is not None else None

    def is_new_stop(self, token: str, stops: int) -> bool:
        """Return whether a pupil's STOP count is new; a missing count always is."""
        group = self.group_of(token)
        if group is None or not stops:
            return True
        member = group.member_by_token[token]
        is_new, member.stop_count = stops > member.stop_count, max(stops, member.stop_count)
        return is_new

    def overview(self) -> list[Json]:
        """Return the overview of all groups for a pupil."""
        with self._lock:
            return [{"name": group.name, "members": [member.name for member in group.pupils]}
                    for group in self._group_by_key.values()]  # fmt: skip

    def group_by_key(self, key: object) -> Group | None:
        with self._lock:
            return self._group_by_key.get(str(key))

    def all(self) -> list[Group]:
        with self._lock:
            return [*self._group_by_key.values()]

    def history(self, group: Group) -> list[Json]:
        """Return the history of changes, with their authors if known."""
        with group.condition:
            return [
                {**taken_change.data(), "who": group.name_of_page.get(_page_name(taken_change), "")}
                for taken_change in group.program.taken_changes
            ]

    def history_lines(self, group: Group) -> list[str]:
        """Return the newest of that, one a line, as the teacher's page shows it."""
        with group.condition:
            actions = [
                (
                    group.name_of_page.get(_page_name(taken_change), "?"),
                    ", ".join(map(_operation_text, taken_change.operations)),
                )
                for taken_change in reversed(group.program.taken_changes[-MAX_HISTORY_LINES:])
            ]
        return [f"{member_name}: {action}" for member_name, action in actions]

    def end(self) -> None:
        """Forget all groups, and their stored data."""
        with self._lock:
            for group in self._group_by_key.values():
                with group.condition:
                    group.member_by_token.clear()
                    _notify(group)
                group.journal.forget()
            self._group_by_key.clear()

    def state_to_keep(self) -> list[Json]:
        """Return the state with which groups resume after a crash, besides their journals."""
        with self._lock:
            return [
                {
                    "key": group.key,
                    "name": group.name,
                    "founder": group.founder,
                    "owners": group.owner_of_page,
                    "names": group.name_of_page,
                    "members": [[member.token, member.name, member.page]
                                for member in group.member_by_token.values()],
                }
                for group in self._group_by_key.values()
            ]  # fmt: skip

    def resume(self, rows: list[Json], is_here: Callable[[str], bool]) -> None:
        """Resume groups after a crash; damaged parts are left out."""
        with self._lock:
            for row in rows:
                key, name, founder = row.get("key"), row.get("name"), row.get("founder")
                group_name = plain_name(name) if isinstance(name, str) else ""
                is_key = isinstance(key, str) and re.fullmatch("[0-9a-f]{32}", key) is not None
                if not is_key or not group_name or len(self._group_by_key) >= MAX_GROUPS:
                    continue
                group = self._add_group(group_name, str(founder), str(key), None)
                if group is None:
                    continue
                owners = row.get("owners")
                owner_of_page = dict.fromkeys(group.program.last_count_by_page, "")
                owner_of_page.update(owners if isinstance(owners, dict) else {})
                group.owner_of_page = {page: str(owner) for page, owner in owner_of_page.items()
                                if _PAGE_NAME.fullmatch(page)}  # fmt: skip
                names = row.get("names")
                group.name_of_page = {
                    page: plain_name(name)
                    for page, name in (names.items() if isinstance(names, dict) else ())
                    if _PAGE_NAME.fullmatch(page) and isinstance(name, str)
                }
                members = row.get("members")
                for member_data in members if isinstance(members, list) else ():
                    self._restore_member(group, member_data, is_here)

    def tidy(self) -> None:
        """Delete journals of groups that there are not any more."""
        with self._lock, suppress(OSError):
            for path in self._folder.iterdir() if self._folder is not None else ():
                if path.name.partition(".")[0] not in self._group_by_key:
                    path.unlink()

    def _restore_member(
        self, group: Group, member_data: object, is_here: Callable[[str], bool]
    ) -> None:
        if not isinstance(member_data, list) or len(member_data) != 3:
            return
        token, name, page = map(str, member_data)
        if (
            is_here(token)
            and _PAGE_NAME.fullmatch(page)
            and len(group.member_by_token) < MAX_MEMBERS
        ):
            mark = len(group.member_by_token)
            group.member_by_token[token] = Member(token, name, page, self._clock(), mark)


def _page_number(page: str) -> int:
    return int(page[1:])


def _tree_of(text: str) -> Tree:
    """Return the tree of a program with which a group begins. Raises Unparsed, Refused."""
    numbers = count(1)
    rows, _ = split_loose(LINE_END.split(text))
    tree = parse_tree("\n".join(rows), lambda: f"i.{next(numbers)}")
    if len(text_of(tree)) > MAX_CHARACTERS:
        raise Refused(TOO_LONG)
    return tree_of(tree.snapshot())


def _notify(group: Group) -> None:
    group.version += 1
    group.condition.notify_all()


def _member_data(member: Member) -> Json:
    return {"name": member.name, "mark": member.mark, "at": member.node_id, "writes": member.writes}


def _operation_text(operation: Operation) -> str:
    """Return the text of an operation, in signs that are the same in each language."""
    if isinstance(operation, Insert):
        return "+ " + "; ".join(node.text for node in operation.nodes)
    if isinstance(operation, Delete):
        return f"− {len(operation.ids)}"
    if isinstance(operation, Replace):
        return "→ " + " ".join(str(value) for _, value in operation.fields if value)
    return "+ " + operation.node.text if isinstance(operation, Wrap) else "↕"


def _page_name(taken_change: TakenChange) -> str:
    return page_and_count(taken_change.uid)[0]
