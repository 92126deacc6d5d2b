# SPDX-License-Identifier: Apache-2.0
"""Mutants of the second decoder: programs that differ from it in one place (mutate.py).

A mutation replaces nodes of a module's syntax tree. Annotations, what is imported for them, strings and the command line of decoder.py are
left alone.
"""
from __future__ import annotations

import ast
from pathlib import Path
from typing import Callable, Iterator, NamedTuple, Optional

# Modules, and the stems whose vectors are run first against their mutants.
MODULES = {
    "conventions": ("rigid", "scene"), "scene": ("scene",), "file": ("file",), "packet": ("packet",), "range_coder": ("range",),
    "rigid": ("rigid",), "load": ("load",), "replica": ("client",), "curve": ("client",), "playout": ("client",), "smoothing": ("client",),
    "driven": ("client",), "elastic": ("client",), "elastic_step": ("client",), "elastic_touch": ("client",), "elastic_matrix": ("client", "scene"),
    "elastic_header": ("scene",),
    "start_models": ("rigid", "deformable"),
    "decoder": ("packet", "client"), "scene_decoder": ("packet", "client"),
    "deformable_basis": ("deformable",), "deformable_clusters": ("deformable",), "deformable_header": ("deformable",), "deformable_graph": ("deformable",), "deformable_main": ("deformable",),
    "deformable_motion": ("deformable",), "deformable_decoder": ("deformable", "packet"),
    "thesis_mesh": ("thesis",), "interpolation": ("thesis",)}
LEFT_ALONE = {"main"}                                       # functions
KINDS = ("constant", "index", "comparison", "clamp", "arithmetic", "rounding", "condition", "check", "order")

COMPARISONS = {ast.Lt: (ast.LtE, ast.GtE), ast.LtE: (ast.Lt, ast.Gt), ast.Gt: (ast.GtE, ast.LtE), ast.GtE: (ast.Gt, ast.Lt),
               ast.Eq: (ast.NotEq,), ast.NotEq: (ast.Eq,), ast.Is: (ast.IsNot,), ast.IsNot: (ast.Is,), ast.In: (ast.NotIn,),
               ast.NotIn: (ast.In,)}
OPERATORS = {ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Add, ast.LShift: ast.RShift, ast.RShift: ast.LShift,
             ast.BitAnd: ast.BitOr, ast.BitOr: ast.BitAnd, ast.BitXor: ast.BitOr}
LIMITS = {"sat32": 0, "lim": 0, "to": 1, "abs": 0}          # functions that limit the argument of this number
READS = {"take", "varint", "next"}                          # what takes bytes of the input; what calls these does too


class Mutation(NamedTuple):
    """`slots` are positions in lists of nodes or fields of nodes, and what is put there."""
    kind: str
    line: int
    where: str                                              # function, empty outside of any
    change: str
    slots: list[tuple]


class Mutant(NamedTuple):
    id: str
    module: str
    mutation: Mutation

    def location(self) -> str:
        return f"{self.module}.py:{self.mutation.line}"


class Module:
    """A module's syntax tree and its mutants."""

    def __init__(self, folder: Path, name: str, raising: set[str], reading: set[str]):
        self.name, self.file = name, folder / f"{name}.py"
        self.tree = ast.parse(self.file.read_text("utf-8"))
        self.raising, self.reading = raising, reading
        self.mutants = self.numbered(self.of_body(self.tree, "body", ""))
        self.functions = {first_line(f): f.end_lineno or 0 for f in functions_of(self.tree)}

    def numbered(self, mutations: Iterator[Mutation]) -> list[Mutant]:
        """Equal changes in one function are distinguished by a number."""
        seen: dict[str, int] = {}
        mutants = []
        for m in mutations:
            name = f"{self.name}.{m.where}: {m.change}" if m.where else f"{self.name}: {m.change}"
            seen[name] = seen.get(name, 0) + 1
            mutants.append(Mutant(name if seen[name] == 1 else f"{name} ({seen[name]})", self.name, m))
        return mutants

    def function_of(self, mutant: Mutant) -> Optional[int]:
        """The first line of the function that the mutation is in, if it is in one and not among its defaults."""
        line = mutant.mutation.line
        return next((first for first, last in self.functions.items() if first < line <= last), None)

    def code_of(self, mutant: Mutant):
        """Compiles the mutant; the tree stays changed, so this is for a process of its own."""
        for holder, key, new in mutant.mutation.slots:
            if isinstance(holder, list):
                holder[key] = new
            else:
                setattr(holder, key, new)
        return compile(ast.fix_missing_locations(self.tree), str(self.file), "exec")

    # ---- Statements ----

    def of_body(self, holder: ast.AST, field: str, where: str) -> Iterator[Mutation]:
        body = getattr(holder, field)
        for i, statement in enumerate(body):
            yield from self.of_statement(body, i, statement, where)
        yield from self.orders(body, where)

    def of_statement(self, body: list, i: int, s: ast.stmt, where: str) -> Iterator[Mutation]:
        if isinstance(s, (ast.FunctionDef, ast.ClassDef)):
            if s.name not in LEFT_ALONE:
                inner = f"{where}.{s.name}" if where else s.name
                if isinstance(s, ast.FunctionDef):
                    for k, default in enumerate(s.args.defaults):
                        yield from self.of_expression(s, (s.args.defaults, k), default, inner)
                yield from self.of_body(s, "body", inner)
            return
        if isinstance(s, ast.If) and ast.unparse(s.test).startswith(("__name__", "TYPE_CHECKING")):
            return
        if isinstance(s, ast.Raise) or calls(s) == "require":
            yield Mutation("check", s.lineno, where, f"{short(s)} -> none", [(body, i, ast.copy_location(ast.Pass(), s))])
        if isinstance(s, ast.AugAssign) and type(s.op) in OPERATORS:
            new = OPERATORS[type(s.op)]()
            changed = ast.AugAssign(s.target, new, s.value)
            yield Mutation("arithmetic", s.lineno, where, f"{short(s)} -> {short(changed)}", [(s, "op", new)])
        for field, value in ast.iter_fields(s):
            if field in ("body", "orelse", "finalbody") and isinstance(value, list):
                yield from self.of_body(s, field, where)
            elif field == "handlers":
                for handler in value:
                    yield from self.of_body(handler, "body", where)
            elif field != "annotation":
                yield from self.of_field(s, field, value, where)

    def orders(self, body: list, where: str) -> Iterator[Mutation]:
        """Two statements, each of which may refuse the input, in the other order."""
        checks = [i for i, s in enumerate(body) if not isinstance(s, (ast.FunctionDef, ast.ClassDef)) and self.does(s, self.raising)]
        for i, j in zip(checks, checks[1:]):
            first, second, between = body[i], body[j], body[i + 1:j]
            if self.does(first, self.reading) and self.does(second, self.reading):
                continue                                    # it would read other bytes
            if leaves(first) or leaves(second) or any(depends(s, first) or depends(first, s) for s in [*between, second]):
                continue
            change = f"{short(first)} <-> {short(second)}"
            moved = [*between, second, first]
            yield Mutation("order", first.lineno, where, change, [(body, i + k, s) for k, s in enumerate(moved)])

    def does(self, s: ast.stmt, names: set[str]) -> bool:
        return any(isinstance(n, ast.Call) and called(n) in names for n in ast.walk(s)) or \
            names is self.raising and any(isinstance(n, ast.Raise) for n in ast.walk(s))

    # ---- Expressions ----

    def of_field(self, owner: ast.AST, field: str, value, where: str) -> Iterator[Mutation]:
        if isinstance(value, ast.expr):
            yield from self.of_expression(owner, (owner, field), value, where)
        elif isinstance(value, list):
            for k, item in enumerate(value):
                if isinstance(item, ast.expr):
                    yield from self.of_expression(owner, (value, k), item, where)
                elif isinstance(item, (ast.comprehension, ast.keyword)):
                    for name, inner in ast.iter_fields(item):
                        yield from self.of_field(item, name, inner, where)
        if field in ("test", "ifs"):
            yield from self.forced(owner, field, value, where)

    def forced(self, owner: ast.AST, field: str, value, where: str) -> Iterator[Mutation]:
        """A condition that is always true, or always false."""
        slots = [(value, k) for k in range(len(value))] if isinstance(value, list) else [(owner, field)]
        for slot, test in zip(slots, value if isinstance(value, list) else [value]):
            for new in (True, False):
                if not (isinstance(owner, ast.While) and new):
                    change = f"{KEYWORDS[type(owner)]} {short(test)} -> {new}"
                    constant = ast.copy_location(ast.Constant(new), test)
                    yield Mutation("condition", test.lineno, where, change, [(*slot, constant)])

    def of_expression(self, owner: ast.AST, slot: tuple, e: ast.expr, where: str) -> Iterator[Mutation]:
        for kind, new in changes(e):
            if isinstance(owner, ast.Slice) or isinstance(owner, ast.Subscript) and slot[1] == "slice":
                kind = "index"
            change = f"{short(e)} -> {short(new)}"
            if isinstance(e, ast.Constant):
                change += f" in {short(owner)}"
            yield Mutation(kind, e.lineno, where, change, [(*slot, ast.copy_location(new, e))])
        if isinstance(e, ast.Subscript) and isinstance(e.slice, (ast.Name, ast.BinOp, ast.Attribute, ast.Call)):
            for op in (ast.Add(), ast.Sub()):
                new = ast.BinOp(e.slice, op, ast.Constant(1))
                change = f"{short(e)} -> {short(ast.Subscript(e.value, new, e.ctx))}"
                yield Mutation("index", e.lineno, where, change, [(e, "slice", new)])
        for field, value in ast.iter_fields(e):
            yield from self.of_field(e, field, value, where)


def functions_of(tree: ast.Module) -> Iterator[ast.FunctionDef]:
    """Those of the module and of its classes, not those inside others."""
    for node in tree.body:
        if isinstance(node, ast.FunctionDef):
            yield node
        elif isinstance(node, ast.ClassDef):
            yield from (inner for inner in node.body if isinstance(inner, ast.FunctionDef))


def first_line(function: ast.FunctionDef) -> int:
    return min([function.lineno] + [decorator.lineno for decorator in function.decorator_list])


KEYWORDS = {ast.If: "if", ast.IfExp: "if", ast.While: "while", ast.comprehension: "if"}


def short(node: ast.AST) -> str:
    """The first line of a node's text."""
    text = ast.unparse(node)
    return text if "\n" not in text else text[:text.index("\n")] + " ..."


def called(call: ast.Call) -> str:
    """The last name of what is called."""
    return call.func.attr if isinstance(call.func, ast.Attribute) else call.func.id if isinstance(call.func, ast.Name) else ""


def calls(s: ast.stmt) -> str:
    return called(s.value) if isinstance(s, ast.Expr) and isinstance(s.value, ast.Call) else ""


def leaves(s: ast.stmt) -> bool:
    return any(isinstance(n, (ast.Return, ast.Yield, ast.Break, ast.Continue)) for n in ast.walk(s))


def names(s: ast.stmt, context: type) -> set[tuple[str, str]]:
    """Names, and attributes of names, that a statement gives a value (Store) or uses (Load)."""
    found = set()

    def visit(node: ast.AST) -> None:
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            if isinstance(node.ctx, context):
                found.add((node.value.id, node.attr))
            return
        if isinstance(node, ast.Subscript) and isinstance(node.ctx, context) and context is ast.Store:
            found.add((ast.unparse(node.value), ""))
        if isinstance(node, ast.Name) and isinstance(node.ctx, context):
            found.add((node.id, ""))
        for child in ast.iter_child_nodes(node):
            visit(child)

    visit(s)
    return found


def depends(s: ast.stmt, other: ast.stmt) -> bool:
    """Whether a statement uses what another one gives a value."""
    return any(a == b and (p == q or "" in (p, q)) for a, p in names(s, ast.Load) for b, q in names(other, ast.Store))


def changes(e: ast.expr) -> Iterator[tuple[str, ast.expr]]:
    """What an expression turns into, apart from its parts."""
    if isinstance(e, ast.Constant) and type(e.value) in (int, bool):
        values = [not e.value] if isinstance(e.value, bool) else [e.value + 1, e.value - 1, 0]
        for value in dict.fromkeys(v for v in values if v != e.value):
            yield "constant", ast.Constant(value) if value >= 0 else ast.UnaryOp(ast.USub(), ast.Constant(-value))
    elif isinstance(e, ast.Compare):
        for i, op in enumerate(e.ops):
            for new in COMPARISONS[type(op)]:
                yield "comparison", ast.Compare(e.left, [*e.ops[:i], new(), *e.ops[i + 1:]], e.comparators)
    elif isinstance(e, ast.BoolOp):
        for i in range(len(e.values)):
            rest = e.values[:i] + e.values[i + 1:]
            yield "condition", rest[0] if len(rest) == 1 else ast.BoolOp(e.op, rest)
    elif isinstance(e, ast.UnaryOp):
        yield "condition" if isinstance(e.op, ast.Not) else "arithmetic", e.operand
    elif isinstance(e, ast.BinOp) and not any(isinstance(n, (ast.Tuple, ast.List, ast.JoinedStr)) for n in (e.left, e.right)):
        yield from changed_operators(e)
    elif isinstance(e, ast.Call):
        yield from changed_calls(e)


def ceiling(op: ast.operator) -> Callable[[ast.expr, ast.expr], ast.expr]:
    return lambda a, b: ast.UnaryOp(ast.USub(), ast.BinOp(ast.UnaryOp(ast.USub(), a), op, b))


def changed_operators(e: ast.BinOp) -> Iterator[tuple[str, ast.expr]]:
    if type(e.op) in OPERATORS:
        yield "arithmetic", ast.BinOp(e.left, OPERATORS[type(e.op)](), e.right)
    if isinstance(e.op, (ast.RShift, ast.FloorDiv)):
        yield "rounding", ceiling(e.op)(e.left, e.right)
    if isinstance(e.op, ast.Mod):
        yield "arithmetic", e.left


def changed_calls(e: ast.Call) -> Iterator[tuple[str, ast.expr]]:
    name, args = called(e), e.args
    if name == "clamp":
        yield "clamp", args[0]
        yield "clamp", ast.Call(ast.Name("min", ast.Load()), [args[0], args[2]], [])
        yield "clamp", ast.Call(ast.Name("max", ast.Load()), [args[0], args[1]], [])
    elif name in ("min", "max"):
        yield "clamp", ast.Call(ast.Name("max" if name == "min" else "min", ast.Load()), args, e.keywords)
        if len(args) == 2:
            yield "clamp", args[0]
            yield "clamp", args[1]
    elif name in LIMITS:
        yield "clamp", args[LIMITS[name]]
    elif name == "round_shift":
        yield "rounding", ast.BinOp(args[0], ast.RShift(), args[1])
    elif name == "round_div":
        yield "rounding", ast.BinOp(args[0], ast.FloorDiv(), args[1])
    elif name == "reversed":
        yield "condition", args[0]


# ---- Which functions refuse input, and which read it ----------------------------------------------------------------
def callers(trees: list[ast.Module], start: set[str], also: Optional[Callable] = None) -> set[str]:
    """Names of functions that call one of `start`, directly or through others."""
    functions = [f for tree in trees for f in ast.walk(tree) if isinstance(f, ast.FunctionDef)]
    names = start | {f.name for f in functions if also and any(also(n) for n in ast.walk(f))}
    while True:
        more = {f.name for f in functions
                if any(isinstance(n, ast.Call) and called(n) in names for n in ast.walk(f))} - names
        if not more:
            return names
        names |= more


def all_mutants(folder: Path) -> dict[str, Module]:
    trees = [ast.parse((folder / f"{name}.py").read_text("utf-8")) for name in MODULES]
    raising = callers(trees, {"require"}, lambda n: isinstance(n, ast.Raise))
    reading = callers(trees, READS)
    return {name: Module(folder, name, raising, reading) for name in MODULES}
