"""A remark on an optimum: a sentence that carries what it speaks of."""

from __future__ import annotations

from typing import Literal

Kind = Literal["how known", "unsure", "atlas", "choices", "judged"]
OF_THE_ERROR: tuple[Kind, ...] = ("how known", "unsure")  #: what a reference's word replaces


class Remark(str):
    """A sentence, with the kind of thing it says.

    Parameters
    ----------
    text
        The sentence.
    kind
        ``"how known"``: how the error is known; ``"unsure"``: that it is large or not known;
        ``"atlas"``: what the atlas left out; ``"choices"``: what was not compared;
        ``"judged"``: what the reference found.

    Examples
    --------
    >>> Remark("at the edge of the atlas", "atlas").kind
    'atlas'
    """

    kind: Kind

    def __new__(cls, text: str, kind: Kind) -> Remark:
        """Create the sentence."""
        made = super().__new__(cls, text)
        made.kind = kind
        return made

    def __getnewargs__(self) -> tuple[str, Kind]:  # type: ignore[override]
        return str(self), self.kind
