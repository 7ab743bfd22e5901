"""Values with named parts are those of `typing.NamedTuple`."""

from __future__ import annotations

import copy
import pickle
from typing import NamedTuple

import pytest

from tiniscript import records


class Ours(records.NamedTuple):
    """A place."""

    x: int
    y: int = 2
    name: str = "here"

    @property
    def both(self) -> int:
        return self.x + self.y


class Theirs(NamedTuple):
    """A place."""

    x: int
    y: int = 2
    name: str = "here"

    @property
    def both(self) -> int:
        return self.x + self.y


class Narrower(Ours):
    __slots__ = ()


class Empty(records.NamedTuple):
    pass


def test_values_are_those_of_a_named_tuple() -> None:
    ours, theirs = Ours(1, name="there"), Theirs(1, name="there")
    assert tuple(ours) == tuple(theirs) == (1, 2, "there")
    assert ours.__eq__(theirs)
    assert hash(ours) == hash(theirs)
    assert (ours.x, ours.y, ours.name, ours.both) == (1, 2, "there", 3)
    assert repr(ours) == repr(theirs).replace("Theirs", "Ours")
    assert ours._asdict() == theirs._asdict()
    assert Ours._fields == Theirs._fields == Ours.__match_args__
    assert Ours._field_defaults == Theirs._field_defaults
    assert Ours.__doc__ == Theirs.__doc__
    assert Ours._make((4, 5, "a")) == Ours(4, 5, "a")
    assert isinstance(ours, tuple) and not hasattr(ours, "__dict__")
    assert Empty() == ()


def test_a_changed_value_is_of_the_same_class() -> None:
    for made in (Ours(1), Narrower(1), Theirs(1)):
        changed = made._replace(y=7)
        assert changed == (1, 7, "here") and type(changed) is type(made)
        with pytest.raises(ValueError, match="z"):
            made._replace(z=1)  # type: ignore[call-arg]


@pytest.mark.parametrize("kind", [Ours, Narrower, Theirs])
def test_wrong_values_are_refused_and_none_can_be_set(kind: type[Ours]) -> None:
    for wrong in ((), (1, 2, "a", 4)):
        with pytest.raises(TypeError):
            kind(*wrong)
    with pytest.raises(TypeError):
        kind(1, z=2)  # type: ignore[call-arg]
    with pytest.raises(AttributeError):
        kind(1).x = 5  # type: ignore[misc]


def test_the_first_value_may_be_made_in_any_way() -> None:
    def fresh() -> type[Ours]:
        class Fresh(records.NamedTuple):
            x: int
            y: int = 2
            name: str = "here"

        return Fresh  # type: ignore[return-value]

    wanted = [(1, 2, "here")] * 3
    assert [tuple(each) for each in (fresh()(1), fresh()(x=1), fresh()._make((1, 2)))] == wanted
    kind = fresh()
    with pytest.raises(TypeError):
        kind()  # type: ignore[call-arg]
    assert tuple(kind(5)) == (5, 2, "here")


def test_values_are_copied_sent_and_matched() -> None:
    for made in (Ours(1, 3), Narrower(1, 3)):
        for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1):
            sent = pickle.loads(pickle.dumps(made, protocol))
            assert sent == made and type(sent) is type(made)
        assert copy.deepcopy(made) == made
        match made:
            case Ours(x, y):
                assert (x, y) == (1, 3)
            case _:
                pytest.fail("no match")
