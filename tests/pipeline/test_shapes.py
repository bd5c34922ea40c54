"""Every tensor that a public function of the simulator takes or returns has its shape in the signature.

Under test jaxtyping and beartype check those shapes at every call (tests/conftest.py).
"""

import ast
from collections.abc import Iterator

import pytest

from simgap.artifacts import PROJECT_ROOT

PACKAGES = ("physics", "platforms", "effects", "simulation")


def untyped(text: str) -> Iterator[str]:
    """Yield where a public function, a field of a public class or a type alias says `Tensor` without a shape."""
    for name, annotation in annotations(ast.parse(text).body):
        if says_bare_tensor(annotation):
            yield f"{name}: {ast.unparse(annotation)}"


def annotations(body: list[ast.stmt], prefix: str = "") -> Iterator[tuple[str, ast.expr]]:
    for node in body:
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            yield from annotations(node.body, f"{prefix}{node.name}.")
        elif isinstance(node, ast.FunctionDef) and not node.name.startswith("_"):
            arguments = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]
            found = [(each.arg, each.annotation) for each in arguments] + [("return", node.returns)]
            yield from ((f"{prefix}{node.name}.{name}", part) for name, part in found if part is not None)
        elif isinstance(node, ast.AnnAssign):
            yield f"{prefix}{ast.unparse(node.target)}", node.annotation
        elif (
            isinstance(node, ast.Assign) and not prefix and isinstance(node.value, ast.BinOp | ast.Subscript)
        ):
            yield ast.unparse(node.targets[0]), node.value  # an alias such as `float | Tensor`


def says_bare_tensor(annotation: ast.expr) -> bool:
    """Whether a type names `Tensor` other than as the array of a shape, `Float[Tensor, "*batch 3"]`."""
    if isinstance(annotation, ast.Constant) and isinstance(annotation.value, str):
        return says_bare_tensor(ast.parse(annotation.value, mode="eval").body)
    if isinstance(annotation, ast.Name | ast.Attribute):
        return ast.unparse(annotation) in ("Tensor", "torch.Tensor")
    if isinstance(annotation, ast.Subscript):
        inside = annotation.slice.elts if isinstance(annotation.slice, ast.Tuple) else [annotation.slice]
        if len(inside) == 2 and isinstance(inside[1], ast.Constant) and isinstance(inside[1].value, str):
            return False
        return says_bare_tensor(annotation.value) or any(map(says_bare_tensor, inside))
    return any(
        says_bare_tensor(part) for part in ast.iter_child_nodes(annotation) if isinstance(part, ast.expr)
    )


@pytest.mark.parametrize("package", PACKAGES)
def test_public_tensors_have_shapes(package):
    files = sorted((PROJECT_ROOT / "pipeline" / package).rglob("*.py"))
    assert len(files) > 5
    found = [f"{path.name}: {each}" for path in files for each in untyped(path.read_text(encoding="utf-8"))]
    assert found == []


@pytest.mark.parametrize(
    "text",
    [
        "def force(speed: Tensor): ...",
        "def force(speed: float) -> torch.Tensor: ...",
        "def force(*, parts: dict[str, Tensor]): ...",
        "def force(speed: 'Entries | Tensor'): ...",
        "class Law:\n    def force(self, speed: tuple[Tensor, Float[Tensor, '3']]): ...",
        "class Law:\n    speed: Tensor | None",
        "Value = float | Tensor",
        "Signals = Mapping[str, Tensor]",
    ],
)
def test_a_tensor_without_a_shape_is_found(text):
    assert list(untyped(text))


def test_shapes_and_private_parts_are_passed_over():
    text = """
Real = Float[Tensor, "*#batch"]
def force(speed: Float[Tensor, "*batch 3"] | None) -> dict[str, Real]: ...
def _inner(speed: Tensor): ...
"""
    assert not list(untyped(text))
