"""What newer versions of Python refuse, found on this one."""

import ast
from pathlib import Path

ROOT = Path(__file__).parents[2]
DOCUMENTED = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)


def test_no_docstring_has_surrogates_with_which_python_3_13_does_not_compile() -> None:
    sources = {
        path: path.read_bytes()
        for package in ("cbtui", "lessons", "sim")
        for path in (ROOT / package).rglob("*.py")
    }
    assert len(sources) > 900
    for path, source in sources.items():
        if rb"\ud" in source.lower():
            documented = (node for node in ast.walk(ast.parse(source)) if isinstance(node, DOCUMENTED))
            docstrings = [ast.get_docstring(node) or "" for node in documented]
            assert not any("\ud800" <= sign <= "\udfff" for text in docstrings for sign in text), path
