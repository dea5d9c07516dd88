"""Arithmetic on named quantities, and constraints: text to functions, nothing else runs.

``swimming_speed / mean_torque``, ``0.2 <= body_rate <= 0.5``. The grammar is Python's, of which
only numbers, names, ``+ - * / **``, ``abs sqrt log min max`` and comparisons are understood. The
values may be numbers, arrays or complex numbers (complex-step derivative).
"""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from microswim.errors import SpecError, nearest
from microswim.gait.quantities import OLD, current, magnitude

LONGEST = 500


#: What an old name stands for where it was a size.
SIZES = {"torque": "abs(mean_torque)"}


class _Today(ast.NodeTransformer):
    """Names of earlier versions become those of today, with a warning."""

    def visit_Name(self, node: ast.Name) -> ast.AST:
        """Replace one name."""
        new = current(node.id)
        return node if new == node.id else ast.parse(SIZES.get(node.id, new), mode="eval").body


OPERATORS: dict[type, Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: np.true_divide,  # zero and overflow give infinity, not an exception
    ast.Pow: np.power,
}
FUNCTIONS: dict[str, tuple[int, Callable[..., Any]]] = {
    "abs": (1, magnitude),
    "sqrt": (1, np.sqrt),
    "log": (1, np.log),
    "min": (2, lambda a, b: np.where(np.real(a) <= np.real(b), a, b)[()]),
    "max": (2, lambda a, b: np.where(np.real(a) >= np.real(b), a, b)[()]),
}


@dataclass(frozen=True)
class Expression:
    """An arithmetic expression.

    Parameters
    ----------
    text
        As it was written.
    names
        The quantities it needs.
    """

    text: str
    names: frozenset[str]
    tree: Any

    def __call__(self, values: Mapping[str, Any]) -> Any:
        """Value for the quantities."""
        with np.errstate(all="ignore"):
            return _value(self.tree, values)


@dataclass(frozen=True)
class Constraint:
    """A one-sided constraint ``margin >= 0``; the margin is relative to the bound.

    Parameters
    ----------
    text
        As it was written, such as ``"mean_torque <= 300"``.
    left, right
        The two sides.
    sense
        +1 for ``left <= right``, -1 for ``left >= right``.
    """

    text: str
    left: Expression
    right: Expression
    sense: float

    @property
    def names(self) -> frozenset[str]:
        """The quantities it needs."""
        return self.left.names | self.right.names

    def margin(self, values: Mapping[str, Any]) -> Any:
        """Return how far inside: positive where it holds, 1 when the left side is zero below a
        bound.
        """
        bound = self.right(values)
        size = magnitude(bound)
        return self.sense * (bound - self.left(values)) / np.where(size == 0, 1.0, size)[()]


def parse(text: str, known: Any) -> Expression:
    """Return an expression of known quantities.

    Raises
    ------
    SpecError
        If it is none; with the nearest name where one is not known.

    Examples
    --------
    >>> float(parse("efficiency / body_rate**2", {"efficiency", "body_rate"})(
    ...     {"efficiency": 8.0, "body_rate": 2.0}
    ... ))
    2.0
    """
    tree = _tree(text)
    made = _expression(tree, text, known)
    if not made.names:
        raise _bad(text, "about a quantity; this is a number")
    return made


def constraints(text: str, known: Any) -> tuple[Constraint, ...]:
    """Return constraints with commas between them; ``a <= x <= b`` makes two.

    Raises
    ------
    SpecError
        If a part is no comparison by ``<=`` or ``>=``.

    Examples
    --------
    >>> from microswim.studies.optimisation.merits import MERITS
    >>> [c.text for c in constraints("mean_torque <= 300, 0.1 <= mean_power", MERITS)]
    ['mean_torque <= 300', '0.1 <= mean_power']
    """
    if not text.strip():
        return ()
    tree = _tree(f"({text},)")
    found: list[Constraint] = []
    for part in tree.elts if isinstance(tree, ast.Tuple) else [tree]:
        if not isinstance(part, ast.Compare):
            raise _bad(ast.unparse(part), 'comparisons such as "mean_torque <= 300"')
        sides = [part.left, *part.comparators]
        for left, sign, right in zip(sides, part.ops, sides[1:]):
            if not isinstance(sign, (ast.LtE, ast.GtE, ast.Lt, ast.Gt)):
                raise _bad(ast.unparse(part), 'comparisons by "<=" or ">="')
            sense = 1.0 if isinstance(sign, (ast.LtE, ast.Lt)) else -1.0
            pair = [_expression(side, ast.unparse(side), known) for side in (left, right)]
            if not pair[0].names | pair[1].names:
                raise _bad(ast.unparse(part), "about a quantity; these are numbers")
            if not pair[0].names and pair[1].names:
                pair, sense = pair[::-1], -sense
            said = f"{ast.unparse(left)} {'<=' if isinstance(sign, (ast.LtE, ast.Lt)) else '>='} "
            found.append(Constraint(said + ast.unparse(right), pair[0], pair[1], sense))
    return tuple(found)


def _bad(text: str, allowed: str) -> SpecError:
    return SpecError("expression", text, allowed)


def _tree(text: str) -> Any:
    if len(text) > LONGEST:
        raise _bad(text, f"at most {LONGEST} characters")
    try:
        return ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise _bad(
            text, 'arithmetic on quantities, such as "swimming_speed / mean_torque"'
        ) from None


def _expression(tree: Any, text: str, known: Any) -> Expression:
    names: set[str] = set()
    tree = _Today().visit(tree)
    _check(tree, text, known, names)
    _check_constants(tree, text)
    return Expression(text, frozenset(names), tree)


def _check(node: Any, text: str, known: Any, names: set[str]) -> None:
    match node:
        case ast.Constant(value=int() | float()) if not isinstance(node.value, bool):
            return
        case ast.Name() | ast.Attribute() | ast.Subscript():
            name = ast.unparse(node)
            if name not in known:
                allowed = f'made of known quantities; "{name}" is none'
                raise SpecError("expression", text, allowed, _nearest(name, known))
            names.add(name)
        case ast.BinOp() if type(node.op) in OPERATORS:
            _check(node.left, text, known, names)
            _check(node.right, text, known, names)
        case ast.UnaryOp(op=ast.USub() | ast.UAdd()):
            _check(node.operand, text, known, names)
        case ast.Call(func=ast.Name(id=name), keywords=[]) if (
            name in FUNCTIONS and len(node.args) == FUNCTIONS[name][0]
        ):
            for argument in node.args:
                _check(argument, text, known, names)
        case _:
            raise _bad(text, "numbers, quantities, + - * / **, " + ", ".join(FUNCTIONS))


def _check_constants(tree: Any, text: str) -> None:
    """Refuse numbers, and what is computed of numbers alone, that are not finite."""
    for node in ast.walk(tree):
        if isinstance(node, (ast.Constant, ast.BinOp, ast.UnaryOp, ast.Call)) and not any(
            isinstance(n, (ast.Attribute, ast.Subscript)) or _is_quantity(n) for n in ast.walk(node)
        ):
            with np.errstate(all="ignore"):
                if not np.isfinite(_value(node, {})):
                    raise _bad(text, "made of finite numbers")


def _is_quantity(node: Any) -> bool:
    """Whether a name is a quantity, and not the function of a call."""
    return isinstance(node, ast.Name) and node.id not in FUNCTIONS


def _nearest(name: str, known: Any) -> str:
    """Return what to offer instead: never a name of an earlier version."""
    return nearest(name, sorted(set(known) - set(OLD)), old=OLD)


def _value(node: Any, values: Mapping[str, Any]) -> Any:
    match node:
        case ast.Constant(value=float() | int() as number):
            try:
                return np.float64(number)  # overflows to infinity, not to an exception
            except OverflowError:
                return np.float64(np.inf)
        case ast.BinOp():
            return OPERATORS[type(node.op)](_value(node.left, values), _value(node.right, values))
        case ast.UnaryOp():
            inner = _value(node.operand, values)
            return -inner if isinstance(node.op, ast.USub) else inner
        case ast.Call(func=ast.Name(id=name)):
            return FUNCTIONS[name][1](*(_value(a, values) for a in node.args))
    return values[ast.unparse(node)]
