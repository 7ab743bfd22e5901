"""Values with named parts, as those of `typing.NamedTuple`, and made in a tenth of its time.

A command makes dozens of classes before it does anything, and ends soon after: with
`typing.NamedTuple` that is a tenth of `tsc compile`, and importing `typing` another one. Modules
that a right program needs take NamedTuple and TYPE_CHECKING from here. For type checkers both are
those of `typing`.

A class compiles its constructor when its first value is made, and keeps no types of its fields.
Every module with one needs `from __future__ import annotations`.
"""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import NamedTuple as NamedTuple
else:
    from operator import itemgetter

    try:
        from _collections import _tuplegetter as _getter
    except ImportError:  # another Python

        def _getter(place, _doc):
            return property(itemgetter(place))

    class _Record(tuple):
        """What all such classes have."""

        __slots__ = ()

        @classmethod
        def _make(cls, values):
            return cls(*values)

        def _replace(self, /, **changed):
            values = [
                changed.pop(name, value) for name, value in zip(self._fields, self, strict=True)
            ]
            if changed:
                raise ValueError(f"Got unexpected field names: {list(changed)!r}")
            return tuple.__new__(type(self), values)

        def _asdict(self):
            return dict(zip(self._fields, self, strict=True))

        def __repr__(self):
            fields = (f"{name}={value!r}" for name, value in zip(self._fields, self, strict=True))
            return f"{type(self).__name__}({', '.join(fields)})"

        def __getnewargs__(self):
            return tuple(self)

    def _first(cls, /, *values, **named):
        """Make the first value of a class, and the constructor for the others."""
        owner = next(each for each in cls.__mro__ if "_fields" in vars(each))
        names = ", ".join(owner._fields)
        new = eval(  # as namedtuple does it
            f"lambda _class, {names}: _new(_class, ({names}{',' if names else ''}))",
            {"_new": tuple.__new__, "__builtins__": {}},
        )
        new.__name__ = "__new__"
        new.__qualname__ = f"{owner.__qualname__}.__new__"
        new.__module__ = owner.__module__
        new.__defaults__ = tuple(owner._field_defaults.values())
        owner.__new__ = staticmethod(new)
        return new(cls, *values, **named)

    class _Kind(type):
        def __new__(cls, name, bases, body):
            fields = tuple(body.get("__annotations__", ()))
            body["_field_defaults"] = {each: body.pop(each) for each in fields if each in body}
            body["_fields"] = body["__match_args__"] = fields
            body["__slots__"] = ()
            body["__new__"] = _first
            for place, each in enumerate(fields):
                body[each] = _getter(place, f"Field {place}")
            return type.__new__(type, name, (_Record,), body)

    NamedTuple = type.__new__(_Kind, "NamedTuple", (), {})
