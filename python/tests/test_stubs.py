"""The stubs name what the module has, and everything in it is documented."""

import ast
import inspect
import pathlib

import supple

STUBS = ast.parse((pathlib.Path(__file__).resolve().parents[1] / "supple/__init__.pyi").read_text())
CLASSES = {node.name: node for node in STUBS.body if isinstance(node, ast.ClassDef)}


def test_the_stubs_name_what_the_module_has():
    functions = {node.name for node in STUBS.body if isinstance(node, ast.FunctionDef)}
    for name in supple.__all__:
        assert name in CLASSES or name in functions, name
    for name in supple.__all__:
        if name not in CLASSES or not inspect.isclass(getattr(supple, name)):
            continue
        stubbed = {node.name for node in CLASSES[name].body if isinstance(node, ast.FunctionDef)}
        stubbed |= {node.target.id for node in CLASSES[name].body if isinstance(node, ast.AnnAssign)}
        inherited = {member for base in (bytes, tuple, BaseException) if issubclass(getattr(supple, name), base)
                     for member in dir(base)}
        here = {member for member in dir(getattr(supple, name)) if not member.startswith("_")} - inherited
        if name == "Grab":
            here |= {"body", "name"}  # of an object
        assert here == {member for member in stubbed if not member.startswith("_")}, name


def test_everything_is_documented():
    for name in supple.__all__:
        thing = getattr(supple, name)
        assert thing.__doc__, name
        for member, value in vars(thing).items() if inspect.isclass(thing) else ():
            if not member.startswith("_") and (callable(value) or isinstance(value, property)):
                assert value.__doc__, f"{name}.{member}"
