"""A place in a list of EXPRESS tokens, with what every declaration needs to move on."""

from collections.abc import Callable
from typing import NoReturn, TypeVar

from docs.hooks.express.lexer import Token, TokenKind
from stepnc_model.errors import SchemaError

Item = TypeVar("Item")


class Cursor:
    """Place in the list of tokens; the one mutable thing here."""

    def __init__(self, found: list[Token]) -> None:
        self._tokens = found
        self._index = 0

    @property
    def next(self) -> Token:
        """Token that comes next."""
        return self._tokens[self._index]

    def take(self) -> Token:
        """Pass the next token; the end stays."""
        token = self.next
        self._index = min(self._index + 1, len(self._tokens) - 1)
        return token

    def skip(self, *texts: str) -> bool:
        """Pass these words or symbols if they come next."""
        ahead = self._tokens[self._index : self._index + len(texts)]
        if len(ahead) < len(texts) or any(
            token.text.upper() != text or token.kind in {TokenKind.STRING, TokenKind.END}
            for token, text in zip(ahead, texts, strict=True)
        ):
            return False
        self._index += len(texts)
        return True

    def expect(self, *texts: str) -> None:
        """Pass these words or symbols, or fail."""
        for text in texts:
            if not self.skip(text):
                self.fail(text)

    def name(self, what: str) -> str:
        """Pass a name, in lower case, or fail."""
        if self.next.kind is not TokenKind.NAME:
            self.fail(what)
        return self.take().text.lower()

    def is_label(self) -> bool:
        """True if a name and a colon come next."""
        ahead = self._tokens[self._index : self._index + 2]
        return len(ahead) == 2 and ahead[0].kind is TokenKind.NAME and ahead[1].text == ":"

    def text_until(self, *ends: str) -> str:
        """Text up to one of these symbols outside all brackets, which is not passed."""
        depth = 0
        words: list[str] = []
        while depth > 0 or self.next.text not in ends or self.next.kind is TokenKind.STRING:
            if self.next.kind is TokenKind.END:
                self.fail(" or ".join(ends))
            token = self.take()
            if token.kind is TokenKind.SYMBOL:
                depth += (token.text in "([") - (token.text in ")]")
            words.append(f" {token.text}" if token.is_apart else token.text)
        return "".join(words).strip()

    def fail(self, expected: str) -> NoReturn:
        """Say what was expected and what is there."""
        token = self.next
        raise SchemaError(f"{expected} expected, found {token.text}", line=token.line)

    def items(self, item: Callable[["Cursor"], Item]) -> list[Item]:
        """Pass a list in brackets, (a, b, c)."""
        self.expect("(")
        found = [item(self)]
        while self.skip(","):
            found.append(item(self))
        self.expect(")")
        return found

    def names(self) -> tuple[str, ...]:
        """Pass a list of names in brackets."""
        return tuple(self.items(lambda cursor: cursor.name("a name")))
