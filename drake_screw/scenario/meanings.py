"""What the keys of a block mean: the docstrings of its fields.

pydantic would read the source of every block at every start, which takes longer than to load a
scenario.
"""

from __future__ import annotations

import ast
import inspect
from functools import cache
from itertools import pairwise

from drake_screw.scenario.block import Block


@cache
def meanings(block: type[Block]) -> dict[str, str]:
    """The docstring of each field of a block that has one, by the field's name, on one line."""
    found = {}
    for one in reversed(block.__mro__):
        if not issubclass(one, Block):
            continue
        (definition,) = ast.parse(inspect.getsource(one)).body
        assert isinstance(definition, ast.ClassDef)
        for field, text in pairwise(definition.body):
            match field, text:
                case (
                    ast.AnnAssign(target=ast.Name(id=name)),
                    ast.Expr(value=ast.Constant(value=str(meaning))),
                ):
                    found[name] = " ".join(meaning.split())
    return found
