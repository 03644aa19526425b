"""A reader of the part of KUKA's robot language that programs here use, and a controller for it.

What it does not know is an error: a statement, a variable that is not declared, a name that is too
long. It executes the program on the arm of :mod:`tests.design.model_arm`.
"""

import re

NAME = re.compile(r"[A-Z_][A-Z0-9_]{0,23}")
_TOKEN = re.compile(
    r"\s*(?:(?P<number>\d+\.?\d*)|(?P<word>\$?[A-Z_][A-Z0-9_]*(?:\[\d+\])?(?:\.[A-Z0-9_]+)?)"
    r"|(?P<enum>#[A-Z_0-9]+)|(?P<sign>==|<>|<=|>=|[-+*/<>(),]))"
)
_WORDS = {"AND": "and", "OR": "or", "NOT": "not", "TRUE": "True", "FALSE": "False"}
_INI = re.compile(r"GLOBAL INTERRUPT DECL|INTERRUPT ON|BAS\(#INITMOV, 0\)")


class KrlError(Exception):
    """The program is not in the language, or does what it must not do."""


def statements(text):
    """Return the lines of a file without comments, folds and headers."""
    found = []
    for line in text.splitlines():
        if not line.isascii():
            raise KrlError(f"not ASCII: {line}")
        bare = line.split(";")[0].strip()
        if bare and not bare.startswith("&"):
            found.append(bare)
    return found


def read_data(text):
    """Return name of the list, constants and structures of a ``.dat``."""
    lines = statements(text)
    head = re.fullmatch(r"DEFDAT (\w+)", lines[0])
    if not head or lines[-1] != "ENDDAT":
        raise KrlError("no DEFDAT ... ENDDAT")
    constants, kinds = {}, {}
    for line in lines[1:-1]:
        if line.startswith("EXT "):
            continue
        match = re.fullmatch(r"DECL (REAL|INT|E6AXIS) (\w+)(?:=(-?\d+(?:\.\d+)?))?", line)
        if not match or not NAME.fullmatch(match[2]):
            raise KrlError(f"in the data: {line}")
        kinds[match[2]] = match[1]
        if match[1] == "E6AXIS":
            constants[match[2]] = {}
        else:
            constants[match[2]] = int(match[3]) if match[1] == "INT" else float(match[3])
    return head[1], constants, kinds


def read_source(text):
    """Return the subprograms of a ``.src``: name -> (parameters, body), the first is the main."""
    found, name = {}, None
    for line in statements(text):
        head = re.fullmatch(r"DEF (\w+) ?\(([^)]*)\)", line)
        if head:
            if name is not None or not NAME.fullmatch(head[1]) or head[1] in found:
                raise KrlError(f"{line}: inside another, too long a name, or there already")
            name = head[1]
            parameters = [part.strip() for part in head[2].split(",") if part.strip()]
            if not all(re.fullmatch(r"\w+ :IN", part) for part in parameters):
                raise KrlError(line)
            found[name] = ([part.split()[0] for part in parameters], [])
        elif line == "END":
            name = None
        elif name is None:
            raise KrlError(f"outside of a program: {line}")
        else:
            found[name][1].append(line)
    if name is not None:
        raise KrlError(f"{name} does not end")
    return found


class Controller:
    """Runs a program on an arm."""

    def __init__(self, source, data, arm, rated, axes=6, mode="#AUT", override=100):
        self.programs = read_source(source)
        name, self.globals, self.kinds = read_data(data)
        if name != next(iter(self.programs)):
            raise KrlError(f"{name} is the data of another program")
        self.arm, self.rated = arm, rated
        self.percent = {axis: 100 for axis in range(1, axes + 1)}
        self.mode, self.override = mode, override
        self.traces = []
        self.began = {}
        self.stopped = {}

    def run(self):
        """Run the main program to its end."""
        self._call(next(iter(self.programs)), [])

    def _call(self, name, values):
        if name not in self.programs:
            raise KrlError(f"no program {name}")
        parameters, body = self.programs[name]
        if len(values) != len(parameters):
            raise KrlError(f"{name} takes {len(parameters)} values")
        scope, kinds = dict(zip(parameters, values, strict=True)), {}
        lines = list(body)
        while lines and lines[0].startswith("DECL "):
            _, kind, names = lines.pop(0).split(" ", 2)
            for one in names.split(","):
                kinds[one.strip()] = kind
                scope.setdefault(one.strip(), None)
        if set(parameters) - set(kinds):
            raise KrlError(f"{name}: a parameter has no type")
        self._block(lines, scope, kinds)

    def _block(self, lines, scope, kinds):
        at = 0
        while at < len(lines):
            line = lines[at]
            if line.startswith("IF "):
                end = self._end(lines, at, "IF ", "ENDIF")
                if self._value(line[3:].removesuffix("THEN"), scope):
                    self._block(lines[at + 1 : end], scope, kinds)
                at = end
            elif line.startswith("WHILE "):
                end = self._end(lines, at, "WHILE ", "ENDWHILE")
                rounds = 0
                while self._value(line[6:], scope):
                    self._block(lines[at + 1 : end], scope, kinds)
                    rounds += 1
                    if rounds > 100_000:
                        raise KrlError(f"endless: {line}")
                at = end
            else:
                self._statement(line, scope, kinds)
            at += 1

    @staticmethod
    def _end(lines, at, begin, end):
        depth = 0
        for place in range(at, len(lines)):
            depth += lines[place].startswith(begin) - (lines[place] == end)
            if depth == 0:
                return place
        raise KrlError(f"without an end: {lines[at]}")

    def _statement(self, line, scope, kinds):
        call = re.fullmatch(r"([A-Z_]\w*) ?\((.*)\)", line)
        if _INI.match(line):
            return
        if line == "HALT":
            self.arm.halted += 1
        elif line.startswith("WAIT SEC "):
            self.arm.wait(self._value(line[9:], scope))
        elif line == "PTP $AXIS_ACT":
            self.arm.move(list(self.arm.positions), [0.0] * 6)
        elif line.startswith("PTP "):
            target = self.globals[line[4:]]
            speeds = [self.rated * self.percent[axis] / 100 for axis in range(1, 7)]
            self.arm.move([target[f"A{axis}"] for axis in range(1, 7)], speeds)
        elif call:
            parts = [part for part in call[2].split(",") if part.strip()]
            self._call(call[1], [self._value(part, scope) for part in parts])
        elif "=" in line:
            name, _, text = line.partition("=")
            self._assign(name.strip(), text.strip(), scope, kinds)
        else:
            raise KrlError(f"unknown statement: {line}")

    def _assign(self, name, text, scope, kinds):
        number = re.fullmatch(r"\$(\w+)\[(\d+)\]", name)
        if name == "$TRACE.NAME[]":
            if not re.fullmatch(r'"\w{1,32}"', text) or text in self.traces:
                raise KrlError(f"{name} = {text}: no name, or one that overwrites a trace")
            self.traces.append(text)
            return
        if name == "$TRACE.MODE":
            if text not in ("#T_START", "#T_STOP"):
                raise KrlError(f"{name} = {text}")
            self.arm.trace(text == "#T_START")
            return
        if text == "$AXIS_ACT":
            self.globals[name] = {f"A{i + 1}": value for i, value in enumerate(self.arm.positions)}
            return
        value = self._value(text, scope)
        if number and number[1] == "VEL_AXIS":
            if value != int(value) or not 1 <= value <= 100:
                raise KrlError(f"{name} = {value}: a whole number of 1 to 100 %")
            self.percent[int(number[2])] = int(value)
        elif number and number[1] == "ACC_AXIS":
            if not 1 <= value <= 100:
                raise KrlError(f"{name} = {value}")
        elif number and number[1] == "TIMER":
            self.began[number[2]] = self.arm.clock - value / 1000.0
        elif number and number[1] == "TIMER_STOP":
            self.stopped[number[2]] = bool(value)
        elif "." in name:
            structure, _, part = name.partition(".")
            if self.kinds.get(structure) != "E6AXIS":
                raise KrlError(f"{structure} is not declared")
            self.globals[structure][part] = float(value)
        elif name in scope and name in kinds:
            scope[name] = round(value) if kinds[name] == "INT" else float(value)
        else:
            raise KrlError(f"{name} is not declared")

    def _value(self, text, scope):
        parts, at, text = [], 0, text.strip()
        while at < len(text):
            token = _TOKEN.match(text, at)
            if not token:
                raise KrlError(f"in {text!r}")
            at = token.end()
            if token["word"]:
                word = token["word"]
                parts.append(_WORDS.get(word) or repr(self._look_up(word, scope)))
            elif token["enum"]:
                parts.append(repr(token["enum"]))
            else:
                parts.append("!=" if token["sign"] == "<>" else token["number"] or token["sign"])
        return eval(" ".join(parts), {"__builtins__": {}})

    def _look_up(self, word, scope):
        number = re.fullmatch(r"\$(\w+)\[(\d+)\]", word)
        if word == "$MODE_OP":
            return self.mode
        if word == "$OV_PRO":
            return self.override
        if word == "$TRACE.STATE":
            return "#TRIGGERED" if self.arm.traced else "#T_END"
        if number and number[1] == "MOT_TEMP":
            return round(self.arm.temperature + 273.15)
        if number and number[1] == "TIMER":
            if self.stopped.get(number[2], True):
                raise KrlError(f"{word} is read while it stands")
            return (self.arm.clock - self.began[number[2]]) * 1000.0
        value = scope.get(word, self.globals.get(word))
        if value is None:
            raise KrlError(f"{word} is not declared, or has no value")
        return value
