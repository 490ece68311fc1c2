"""Functions of arrays that take the keywords of a method of Mesh: written once, and seen by help() and type checkers."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from typing_extensions import Concatenate, ParamSpec

    from .mesh import Faces, Mesh

    Keywords = ParamSpec("Keywords")
Answer = TypeVar("Answer")


def with_keywords_of(
    method: Callable[Concatenate[Mesh, Keywords], Answer],
) -> Callable[[Callable[..., Answer]], Callable[Concatenate[ArrayLike, Faces, Keywords], Answer]]:
    """Gives a function ``(vertices, faces, /, ...)`` the signature of a method, with the arrays in the place of self."""

    def give(function: Callable[..., Answer]) -> Any:
        own, others = inspect.signature(function), inspect.signature(method)
        arrays = list(own.parameters.values())[:2]
        keywords = list(others.parameters.values())[1:]
        function.__signature__ = own.replace(parameters=[*arrays, *keywords])  # type: ignore[attr-defined]
        return function

    return give
