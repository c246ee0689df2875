"""Damage to a valid input: values of a mapping, bytes of a file."""

import copy

from hypothesis import strategies as st

# What stands where a key wants something else; also what is right for a few keys.
ODD_VALUES = (
    *(0, 1, -1, 3, 0.5, 1e30, -1e30, 1e-30, 1e12, 10**400, float("nan"), float("inf")),
    *(True, None, "", "text", "nan", "1e30", "0.5", "é\n", "a" * 5000, "../x", "all"),
    *([], {}, [[]], [0.0, 0.0, 0.0], [0.0, 0.0], [1.0, 1.0], [1, "a", None], {"kind": "none"}),
    *({"kind": "measured"}, {"kind": "x"}, {"a": {"x": 1}}, [{}], {1: 2}, {"first": 1}),
)
# Three times "near": most examples should get past the first check.
WAYS = ("value", "near", "near", "near", "missing", "renamed", "twice", "deep")


def places(value, path=()):
    """Every path (keys and indices) in a mapping, but the root."""
    inner = value.items() if isinstance(value, dict) else enumerate(value) if _list(value) else ()
    for key, each in inner:
        yield (*path, key)
        yield from places(each, (*path, key))


def _list(value):
    return isinstance(value, (list, tuple))


def _numbers_near(value):
    """A number's usual mistakes: sign, unit, power."""
    plain = isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) < 1e99
    return [-value, 1000 * value, 0.001 * value, 1e6 * value, str(value), [value]] if plain else []


@st.composite
def damaged_mapping(draw, mapping, most=3):
    """The mapping with one to three places damaged."""
    data = copy.deepcopy(mapping)
    for _ in range(draw(st.integers(1, most))):
        path = draw(st.sampled_from(list(places(data))))
        level = data
        for part in path[:-1]:
            level = level[part]
        _damage(draw, level, path[-1])
        if not data:
            break
    return data


def _damage(draw, level, key):
    """Damage one entry of a mapping or a list."""
    value = level[key]
    what = draw(
        st.sampled_from(["value", "near", "near", "near", "missing", "renamed", "twice", "deep"])
    )
    if what == "missing":
        del level[key]
    elif what == "renamed" and isinstance(level, dict):
        level[draw(st.sampled_from([f"{key}x", str(key)[:-1], "kind", "name", 7]))] = level.pop(key)
    elif what == "twice" and _list(value):
        level[key] = [*value, *value]
    elif what == "deep":
        level[key] = draw(st.sampled_from([{key: value}, [value], {"one": value}]))
    elif what == "near" and _numbers_near(value):
        level[key] = draw(st.sampled_from(_numbers_near(value)))
    else:
        level[key] = copy.deepcopy(draw(st.sampled_from(ODD_VALUES)))


@st.composite
def damaged_bytes(draw, content):
    """Bytes with a part cut, flipped, repeated, inserted or zeroed; rarely no trace of them."""
    data = bytearray(content)
    for _ in range(draw(st.integers(1, 3))):
        at = draw(st.integers(0, max(0, len(data) - 1)))
        length = draw(st.integers(1, 16))
        what = draw(st.sampled_from(["cut", "flip", "number", "insert", "zero", "repeat", "drop"]))
        if what == "cut":
            del data[at:]
        elif what == "drop":
            del data[at : at + length]
        elif what == "insert":
            data[at:at] = draw(st.binary(min_size=1, max_size=16))
        elif what == "repeat":
            data[at:at] = data[at : at + length]
        elif what == "zero":
            data[at : at + length] = bytes(len(data[at : at + length]))
        elif what == "number":
            data[at : at + 8] = draw(st.sampled_from([2**62, 2**40, 2**31, 2**64 - 1])).to_bytes(
                8, "little"
            )
        elif data:
            data[at] ^= 1 << draw(st.integers(0, 7))
    return bytes(data)
