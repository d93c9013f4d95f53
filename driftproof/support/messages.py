"""Messages between processes: plain values as one line of JSON and back, exactly, with nothing executed on the way.

JSON's null, booleans, strings, lists and short integers stand for themselves; any other value is {"kind": content}. A
float is written in hexadecimal, which keeps every bit, NaN, the infinities and -0.0; a dataclass as name and fields.
"""

from __future__ import annotations

import json
import sys
from dataclasses import fields, is_dataclass
from fractions import Fraction
from typing import Any

from driftproof.support.plain_text import shortened

Plain = Any
# Larger integers are written in hexadecimal, because Python reads no decimal integer of more than 4300 digits.
# Chosen: any bound below 10**4300 would do.
_SHORT_INTEGER = 10**15


class MessageError(ValueError):
    """A text that is not a message written by `encode`."""


def encode(value: Plain) -> str:
    """The value as one line of JSON: None, bool, int, float, complex, str, Fraction, list, tuple, set, dict, dataclass.

    Raises TypeError for anything else.

    >>> encode((1.5, [None, -0.0]))
    '{"tuple": [{"float": "0x1.8000000000000p+0"}, [null, {"float": "-0x0.0p+0"}]]}'
    """
    return json.dumps(_plain(value))


def decode(text: str, package: str = "") -> Plain:
    """The value that `encode` wrote. Raises MessageError for any other text.

    Dataclasses and named tuples are only made if their class belongs to a module of `package` that is already loaded,
    and without running its code: a text from a process that cannot be trusted executes nothing.

    >>> decode(encode({"h": 0.1, "steps": (1, 2)}))
    {'h': 0.1, 'steps': (1, 2)}
    """
    try:
        return _value(json.loads(text), package)
    except MessageError:
        raise
    except (ValueError, TypeError, KeyError, IndexError, AttributeError, ArithmeticError, RecursionError) as error:
        raise MessageError(f"no message: {type(error).__name__}") from None


def _plain(value: Plain) -> Plain:
    match value:
        case None | bool() | str():
            return value
        case int():
            return int(value) if abs(value) < _SHORT_INTEGER else {"int": hex(value)}
        case float():
            return {"float": float(value).hex()}
        case complex():
            return {"complex": [value.real.hex(), value.imag.hex()]}
        case Fraction():
            return {"fraction": [hex(value.numerator), hex(value.denominator)]}
        case list():
            return [_plain(x) for x in value]
        case tuple() if not hasattr(value, "_fields"):
            return {"tuple": [_plain(x) for x in value]}
        case tuple():
            return {"record": [_name(value), [_plain(x) for x in value]]}
        case set() | frozenset():
            return {type(value).__name__: [_plain(x) for x in value]}
        case dict():
            return {"dict": [[_plain(key), _plain(x)] for key, x in value.items()]}
    if is_dataclass(value) and not isinstance(value, type):
        return {"object": [_name(value), {f.name: _plain(getattr(value, f.name)) for f in fields(value)}]}
    raise TypeError(f"{type(value).__module__}.{type(value).__qualname__} is no plain value")


def _name(value: Plain) -> str:
    return f"{type(value).__module__}:{type(value).__qualname__}"


def _value(plain: Plain, package: str) -> Plain:
    if isinstance(plain, list):
        return [_value(x, package) for x in plain]
    if not isinstance(plain, dict):
        return plain
    ((kind, content),) = plain.items()
    match kind:
        case "int":
            return int(content, 16)
        case "float":
            return float.fromhex(content)
        case "complex":
            return complex(*map(float.fromhex, content))
        case "fraction":
            numerator, denominator = content
            return Fraction(int(numerator, 16), int(denominator, 16))
        case "tuple":
            return tuple(_value(content, package))
        case "set" | "frozenset":
            return {"set": set, "frozenset": frozenset}[kind](_value(content, package))
        case "dict":
            return {_value(key, package): _value(x, package) for key, x in content}
        case "record":
            return tuple.__new__(_class(content[0], package), _value(content[1], package))
        case "object":
            made = object.__new__(_class(content[0], package))
            for field in fields(made):
                object.__setattr__(made, field.name, _value(content[1][field.name], package))
            return made
    raise MessageError(f"no message: {shortened(str(kind))!r} is no kind of value")


def _class(named: str, package: str) -> Any:
    """The dataclass or named tuple of a loaded module of `package`."""
    module, _, path = named.partition(":")
    found: Any = sys.modules.get(module) if package and module.startswith(f"{package}.") else None
    for part in path.split("."):
        found = vars(found)[part] if found is not None else None
    if isinstance(found, type) and (is_dataclass(found) or (issubclass(found, tuple) and hasattr(found, "_fields"))):
        return found
    raise MessageError(f"no message: {shortened(named)!r} is no plain class of ours")
