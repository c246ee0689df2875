"""YAML's safe loader with the limits of a configuration.

A key given twice is an error: PyYAML would keep the last. So are tags, numbers that YAML reads in
base 8 or 60, and more nesting or more values than a configuration has. Values count as often as
aliases repeat them, so that a short file can not stand for a huge one.
"""

import re
from collections.abc import Hashable
from typing import Any, NoReturn

import yaml
from yaml.error import MarkedYAMLError
from yaml.events import AliasEvent, CollectionStartEvent, ScalarEvent
from yaml.nodes import MappingNode, Node, ScalarNode

DEEPEST = 30
MOST_VALUES = 100_000
MERGE = "tag:yaml.org,2002:merge"
NO_DECIMAL = re.compile(r"[-+]?(0[0-9_]+|[0-9_.]+:[0-9_.:]+)")  # 010 is 8, 1:30 is 90
# Characters that no name or path can hold, but an escape in quotes can write.
NO_TEXT = re.compile("[\0-\x08\x0b-\x1f\x7f\ud800-\udfff]")


class PlainLoader(yaml.SafeLoader):
    """The loader. Every problem is a MarkedYAMLError, except escapes of no character: ValueError or
    OverflowError.
    """

    def __init__(self, stream: Any) -> None:
        super().__init__(stream)
        self._depth = 0
        self._values = 0
        self._size_of: dict[int, int] = {}  # of complete nodes: values in them

    def compose_node(self, parent: Node | None, index: Any) -> Node | None:
        """Return the next node, within the limits. Raises MarkedYAMLError."""
        event = self.peek_event()
        mark = event.start_mark
        if isinstance(event, (ScalarEvent, CollectionStartEvent)) and event.tag is not None:
            tag = event.tag.replace("tag:yaml.org,2002:", "!!")
            _refuse(f"{tag} is a tag, which no configuration needs: remove it", mark)
        if self._depth >= DEEPEST:
            _refuse(f"is nested in more than {DEEPEST} blocks and lists: remove some", mark)
        self._depth += 1
        before = self._values
        node = super().compose_node(parent, index)
        self._depth -= 1
        if not isinstance(event, AliasEvent):
            self._values += 1
            self._size_of[id(node)] = self._values - before
        elif id(node) in self._size_of:
            self._values += self._size_of[id(node)]
        else:
            _refuse("an alias inside the block that it stands for: write the values out", mark)
        if self._values > MOST_VALUES:
            _refuse(f"the file holds more than {MOST_VALUES} values up to here: shorten it", mark)
        return node

    def construct_object(self, node: Node, deep: bool = False) -> Any:
        """Return the value of a node. Raises MarkedYAMLError."""
        try:
            value = super().construct_object(node, deep)
        except ValueError as error:  # the 45th of a month, a number of 5000 digits
            text = "a date or number that can not be read: correct it, or put a text in quotes"
            raise MarkedYAMLError(problem=text, problem_mark=node.start_mark) from error
        if isinstance(value, str) and NO_TEXT.search(value):
            _refuse("a text that can not be read: remove its escape (\\)", node.start_mark)
        return value

    def construct_mapping(self, node: MappingNode, deep: bool = False) -> dict:
        """Return the mapping of a node. Raises MarkedYAMLError."""
        given: set[Hashable] = set()
        for key_node, _ in node.value:
            if key_node.tag == MERGE:
                continue
            key = self.construct_object(key_node, deep=True)
            if not isinstance(key, Hashable):
                continue  # the safe loader refuses it
            if key in given:
                _refuse(f"key '{key}' is given twice", key_node.start_mark)
            given.add(key)
        return super().construct_mapping(node, deep)

    def construct_decimal(self, node: ScalarNode) -> int | float:
        """Return a number. Raises MarkedYAMLError for one in base 8 or 60."""
        if NO_DECIMAL.fullmatch(node.value):
            _refuse(
                f"{node.value} is ambiguous: write a number without leading 0 and colon, or put a"
                " text in quotes",
                node.start_mark,
            )
        whole = node.tag == "tag:yaml.org,2002:int"
        return self.construct_yaml_int(node) if whole else self.construct_yaml_float(node)


def _refuse(problem: str, mark: Any) -> NoReturn:
    raise MarkedYAMLError(problem=problem, problem_mark=mark)


for kind in ("int", "float"):
    PlainLoader.add_constructor(f"tag:yaml.org,2002:{kind}", PlainLoader.construct_decimal)
