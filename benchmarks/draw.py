"""Random docstrings, messages and page texts, for readers who were not told what they mean.

``python -m benchmarks.draw`` draws 30 docstrings and 30 messages of the product, and 10 texts
of the documentation and the dashboard; ``--seed`` draws others.
"""

import argparse
import ast
import random
import re
from collections.abc import Iterator
from pathlib import Path

from benchmarks.house import PRODUCT, ROOT, Definition, House

LEAST_WORDS = 4
"""words of a message or page text; fewer are labels"""

Text = tuple[str, str]
"""where it stands, and the text"""


def docstrings(house: House) -> Iterator[Text]:
    """First lines of docstrings, and texts below attributes."""
    for module, tree in house.trees.items():
        for node in ast.walk(tree):
            if isinstance(node, Definition | ast.Module):
                name = "" if isinstance(node, ast.Module) else f".{node.name}"
                if text := ast.get_docstring(node):
                    yield module + name, text.split("\n\n")[0]
            if isinstance(node, ast.ClassDef):
                yield from _attributes(node, f"{module}.{node.name}")


def _attributes(node: ast.ClassDef, owner: str) -> Iterator[Text]:
    for before, after in zip(node.body, node.body[1:], strict=False):
        if isinstance(before, ast.AnnAssign | ast.Assign) and isinstance(after, ast.Expr):
            target = before.target if isinstance(before, ast.AnnAssign) else before.targets[0]
            if isinstance(after.value, ast.Constant):
                yield f"{owner}.{ast.unparse(target)}", str(after.value.value)


def messages(house: House) -> Iterator[Text]:
    """Texts of errors, findings and progress: sentences in calls."""
    for module, tree in house.trees.items():
        for node in ast.walk(tree):
            if isinstance(node, ast.Call):
                for argument in (*node.args, *(each.value for each in node.keywords)):
                    if isinstance(argument, ast.JoinedStr | ast.Constant):
                        text = _template(argument)
                        if _is_sentence(text):
                            yield f"{module}:{argument.lineno}", text


def _template(node: ast.JoinedStr | ast.Constant) -> str:
    """A text with its expressions in braces."""
    if isinstance(node, ast.Constant):
        return node.value if isinstance(node.value, str) else ""
    return "".join(
        str(part.value) if isinstance(part, ast.Constant) else f"{{{ast.unparse(part.value)}}}"
        for part in node.values
        if isinstance(part, ast.Constant | ast.FormattedValue)
    )


def _is_sentence(text: str) -> bool:
    return len(re.findall(r"[a-z]{2,}", text)) >= LEAST_WORDS and "SELECT" not in text


def pages(root: Path) -> Iterator[Text]:
    """Paragraphs of README and documentation, and texts of the dashboard."""
    for path in (root / "README.md", *sorted((root / "docs").rglob("*.md"))):
        text = re.sub(r"```.*?```", "", path.read_text("utf-8"), flags=re.DOTALL)
        for part in text.split("\n\n"):
            if _is_sentence(part) and not part.lstrip().startswith(("|", "<")):
                yield str(path.relative_to(root)), part.strip()
    for path in sorted((root / "service" / "dashboard").iterdir()):
        if path.suffix in {".js", ".html"}:
            for found in re.findall(r'"([^"\n]+)"|>([^<\n]+)<', path.read_text("utf-8")):
                if _is_sentence("".join(found)):
                    yield str(path.relative_to(root)), "".join(found).strip()


def main(arguments: list[str] | None = None) -> None:
    """Print the draw."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=0)
    chance = random.Random(parser.parse_args(arguments).seed)
    house = House(ROOT, PRODUCT)
    kinds = (
        ("docstrings", sorted(set(docstrings(house))), 30),
        ("messages", sorted(set(messages(house))), 30),
        ("page texts", sorted(set(pages(ROOT))), 10),
    )
    for kind, texts, count in kinds:
        print(f"\n{count} of {len(texts)} {kind}\n")
        for where, text in chance.sample(texts, count):
            print(f"{where}\n    {text.replace(chr(10), f'{chr(10)}    ')}")


if __name__ == "__main__":
    main()
