"""A reader of the part of URScript that programs here use, which runs them on a model arm."""

import math
import re

_BUILT_IN = {
    "movej",
    "sleep",
    "popup",
    "get_joint_temp",
    "get_actual_joint_positions",
    "write_output_integer_register",
    "d2r",
}
_RESERVED = {"and", "or", "not", "True", "False", "a", "v"}


class ScriptError(Exception):
    """The script is not in the language, or does what it must not do."""


class Halted(Exception):
    """The script has ended itself."""


class Robot:
    """Runs a script on an arm; its angles are in rad, as the language has them."""

    def __init__(self, script, arm, fastest=math.pi):
        self.arm, self.fastest = arm, fastest
        self.globals, self.functions = {}, {}
        lines = [line.split("#")[0].rstrip() for line in script.splitlines()]
        self.tree = self._parsed(iter([line.strip() for line in lines if line.strip()]), None)

    def run(self):
        """Run the script's one program; True if it came to its end."""
        (kind, name, _, body), *rest = self.tree
        if kind != "def" or rest or not re.fullmatch(r"[a-z]\w*", name):
            raise ScriptError("expected one program")
        try:
            self._block(body, {})
        except Halted:
            return False
        return True

    def _parsed(self, lines, inside):
        found = []
        for line in lines:
            head = re.fullmatch(r"def (\w+)\(([^)]*)\):", line)
            if head:
                names = [part.strip() for part in head[2].split(",") if part.strip()]
                found.append(("def", head[1], names, self._parsed(lines, line)))
            elif re.fullmatch(r"(if|while) .+:", line):
                kind, _, condition = line[:-1].partition(" ")
                found.append((kind, condition, None, self._parsed(lines, line)))
            elif line == "end":
                if inside is None:
                    raise ScriptError("end of nothing")
                return found
            else:
                found.append(("do", line, None, None))
        if inside is not None:
            raise ScriptError(f"without an end: {inside}")
        return found

    def _block(self, body, scope):
        for kind, text, names, inner in body:
            if kind == "def":
                self.functions[text] = (names, inner)
            elif kind == "if":
                if self._value(text, scope):
                    self._block(inner, scope)
            elif kind == "while":
                rounds = 0
                while self._value(text, scope):
                    self._block(inner, scope)
                    rounds += 1
                    if rounds > 100_000:
                        raise ScriptError(f"endless: {text}")
            else:
                self._statement(text, scope)

    def _statement(self, line, scope):
        if line == "halt":
            self.arm.halted += 1
            raise Halted
        assigned = re.fullmatch(r"(global )?([a-zA-Z_]\w*)(\[\d\])? = (.+)", line)
        if not assigned:
            self._value(line, scope)
            return
        value = self._value(assigned[4], scope)
        where = self.globals if assigned[1] else scope
        if assigned[3]:
            where[assigned[2]][int(assigned[3][1])] = value
        else:
            where[assigned[2]] = list(value) if isinstance(value, list) else value

    def _value(self, text, scope):
        bare = re.sub(r'"[^"]*"', "", text)
        for word in re.findall(r"[a-zA-Z_]\w*", bare):
            known = {*scope, *self.globals, *self.functions, *_BUILT_IN, *_RESERVED}
            if word not in known:
                raise ScriptError(f"{word} is not known in {text!r}")
        names = {name: self._caller(name) for name in self.functions}
        names |= {"movej": self._movej, "sleep": self.arm.wait, "d2r": math.radians}
        names |= {"popup": lambda *_: None, "get_joint_temp": lambda _: self.arm.temperature}
        names["get_actual_joint_positions"] = lambda: [
            math.radians(one) for one in self.arm.positions
        ]
        names["write_output_integer_register"] = lambda _, value: self.arm.trace(bool(value))
        return eval(text, {"__builtins__": {}}, names | self.globals | scope)

    def _caller(self, name):
        parameters, body = self.functions[name]

        def called(*values):
            if len(values) != len(parameters):
                raise ScriptError(f"{name} takes {len(parameters)} values")
            self._block(body, dict(zip(parameters, values, strict=True)))

        return called

    def _movej(self, target, a, v):
        if not 0 < v <= self.fastest or not a > 0:
            raise ScriptError(f"movej with a={a}, v={v}")
        self.arm.move([round(math.degrees(one), 9) for one in target], [math.degrees(v)] * 6)
