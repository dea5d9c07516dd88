"""The dimension of an expression of quantities: that of a limit on it must be the same.

A dimension is its exponents of length, mass, time, ...; an angle counts as a number, so that rates
may be multiplied with times.
"""

from __future__ import annotations

import ast
from collections.abc import Callable
from fractions import Fraction
from typing import Any

from microswim.spec.units import parse

Dimension = dict[str, Fraction]
PLAIN: Dimension = {}


class Mixed(ValueError):
    """Unlike things are added or compared, in words."""


def of_unit(unit: str) -> Dimension:
    """Return the dimension of a unit.

    Examples
    --------
    >>> of_unit("N m") == of_unit("J"), of_unit("rad/s") == of_unit("Hz")
    (True, True)
    """
    if unit in ("", "1"):
        return PLAIN
    found: Any = parse(f"1 {unit}").dimensionality
    return {k: Fraction(float(v)).limit_denominator(12) for k, v in found.items() if k != "[angle]"}


def of_expression(text: str, unit_of: Callable[[str], str | None]) -> Dimension | None:
    """Return the dimension of an expression; None where it depends on numbers or is no expression.

    Parameters
    ----------
    text
        As `expressions.parse` takes it.
    unit_of
        Unit of a name, None for what has none.

    Raises
    ------
    Mixed
        If it adds or compares unlike things.
    """
    try:
        tree = ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return None
    return _of(tree, unit_of)


def _of(node: Any, unit_of: Callable[[str], str | None]) -> Dimension | None:
    match node:
        case ast.Constant():
            return PLAIN
        case ast.UnaryOp():
            return _of(node.operand, unit_of)
        case ast.BinOp(op=ast.Pow()):
            return _power(_of(node.left, unit_of), node.right)
        case ast.BinOp():
            return _joined(node, _of(node.left, unit_of), _of(node.right, unit_of))
        case ast.Call(func=ast.Name(id=name)):
            inside = [_of(a, unit_of) for a in node.args]
            if name == "sqrt" and inside[:1] != [None]:
                return {k: v / 2 for k, v in (inside[0] or {}).items()} if inside else None
            return PLAIN if name == "log" else _alike(node, inside)
        case ast.Name() | ast.Attribute() | ast.Subscript():
            return of_unit(unit_of(ast.unparse(node)) or "")
    return None


def _power(base: Dimension | None, exponent: Any) -> Dimension | None:
    sign = 1
    if isinstance(exponent, ast.UnaryOp) and isinstance(exponent.op, ast.USub):
        sign, exponent = -1, exponent.operand
    if not base:
        return base
    if not isinstance(exponent, ast.Constant) or not isinstance(exponent.value, (int, float)):
        return None
    if abs(exponent.value) > 100:
        return None
    size = Fraction(exponent.value).limit_denominator(12) * sign
    return {k: v * size for k, v in base.items() if size}


def _joined(node: Any, left: Dimension | None, right: Dimension | None) -> Dimension | None:
    if left is None or right is None:
        return None
    if isinstance(node.op, (ast.Mult, ast.Div)):
        sign = 1 if isinstance(node.op, ast.Mult) else -1
        total = {k: left.get(k, Fraction(0)) + sign * right.get(k, 0) for k in left | right}
        return {k: v for k, v in total.items() if v}
    return _alike(node, [left, right])


def _alike(node: Any, parts: list[Dimension | None]) -> Dimension | None:
    known = [part for part in parts if part is not None]
    if any(part != known[0] for part in known):
        raise Mixed(f"{ast.unparse(node)} adds or compares unlike things")
    return known[0] if len(known) == len(parts) and known else None
