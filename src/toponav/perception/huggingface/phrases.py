"""Categories as words for a model that reads: prompts, and which words a box answers to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

SEPARATOR = ". "
"""Between the phrases of a grounding prompt, which ends with a full stop too."""

SPECIAL_TOKENS = 2
"""A tokenizer's marks of beginning and end."""


@dataclass(frozen=True, eq=False)
class GroundingPrompt:
    """A text that names several things, and where in its tokens each is named.

    Attributes:
        text: Such as "chair. potted plant."
        tokens: (P, T) bool, which tokens name each of the P phrases.
    """

    text: str
    tokens: NDArray[np.bool_]

    def scores(self, token_scores: NDArray[np.floating]) -> NDArray[np.float64]:
        """(Q, P) how well each of Q boxes fits each phrase: its words' mean.

        Args:
            token_scores: (Q, T or more) in [0, 1], of each box and token.
        """
        fit = token_scores[:, : self.tokens.shape[1]].astype(np.float64)
        shares: NDArray[np.float64] = self.tokens / self.tokens.sum(axis=1, keepdims=True)
        return fit @ shares.T


def grounding_prompts(
    tokenizer: Any, phrases: Sequence[str], max_tokens: int
) -> list[tuple[slice, GroundingPrompt]]:
    """As few prompts as name all phrases, each with which of them it names.

    Args:
        tokenizer: A fast one, which tells the characters of a token.
        phrases: Prose, without full stops.
        max_tokens: As many fit into the model's text.
    """
    lengths = [len(tokenizer(phrase + SEPARATOR, add_special_tokens=False).input_ids)
               for phrase in phrases]  # fmt: skip
    parts, first, used = [], 0, SPECIAL_TOKENS
    for index, length in enumerate(lengths):
        if used + length > max_tokens and index > first:
            parts.append(slice(first, index))
            first, used = index, SPECIAL_TOKENS
        used += length
    parts.append(slice(first, len(phrases)))
    return [(part, _prompt(tokenizer, phrases[part])) for part in parts]


def _prompt(tokenizer: Any, phrases: Sequence[str]) -> GroundingPrompt:
    text = SEPARATOR.join(phrases) + SEPARATOR.rstrip()
    spans = np.array(tokenizer(text, return_offsets_mapping=True).offset_mapping)
    tokens = np.zeros((len(phrases), len(spans)), np.bool_)
    start = 0
    for row, phrase in zip(tokens, phrases, strict=True):
        end = start + len(phrase)
        row[:] = (spans[:, 0] >= start) & (spans[:, 1] <= end) & (spans[:, 1] > spans[:, 0])
        start = end + len(SEPARATOR)
    return GroundingPrompt(text, tokens)
