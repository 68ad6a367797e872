"""
Machine code of casadi functions, for chains of many small evaluations.

A casadi function of scalars (``SX``) is a list of elementary operations, which casadi interprets
one by one. Here the list is translated to the intermediate language of LLVM, which comes with
numba, and compiled while the program runs: several times as fast, and still generated from the
expressions of ``push_model``. The code is kept on disk, under a name made of the operations and
the processor. Where llvmlite is missing, casadi evaluates the same function.

An evaluation runs over many rows: row k of every argument and result is an array of its own. Rows
of a result may be rows of an argument too, one further on, so that a row goes on from the one
before. Where no row does, several are evaluated at once, in the lanes of the processor's vectors.
Rows of a gathered argument are picked by numbers, so that several rows may have the same one.

Evaluations that follow one another may be one call, a ``RowSequence``: what one leaves in an
array, the next ones read there.
"""

from collections.abc import Callable, Mapping, Sequence
import ctypes
import functools
import hashlib
import importlib
import threading
from typing import Any, NamedTuple, Optional

import casadi as ca
import numpy as np
from push_dynamics.user_cache import user_cache
from push_model.geometry import FloatArray, IntArray

# From this version of LLVM on, pointers have no type.
FIRST_OPAQUE_VERSION = 17
# Optimisation of LLVM's code generator, 0 to 3. Chosen: casadi has removed what is computed twice.
OPTIMIZATION = 2
# Distance of two float64 [bytes].
ITEM_SIZE = 8
# Rows that are evaluated at once where they are independent. Chosen: float64 in a vector of AVX;
# where vectors are shorter, LLVM divides them.
LANES = 4
# Least number of rows that memory is kept for. Chosen: as many as most pushes take, so that it
# grows once or twice in all.
MIN_CAPACITY = 256

_BINARY = {ca.OP_ADD: 'fadd', ca.OP_SUB: 'fsub', ca.OP_MUL: 'fmul', ca.OP_DIV: 'fdiv'}
_COMPARISONS = {ca.OP_LT: 'olt', ca.OP_LE: 'ole', ca.OP_EQ: 'oeq', ca.OP_NE: 'une'}
_CALLS = {ca.OP_SQRT: 'llvm.sqrt.f64', ca.OP_SIN: 'sin', ca.OP_COS: 'cos', ca.OP_TAN: 'tan',
          ca.OP_ASIN: 'asin', ca.OP_ACOS: 'acos', ca.OP_ATAN: 'atan', ca.OP_ATAN2: 'atan2',
          ca.OP_EXP: 'exp', ca.OP_LOG: 'log', ca.OP_POW: 'pow', ca.OP_CONSTPOW: 'pow',
          ca.OP_FABS: 'llvm.fabs.f64', ca.OP_FMIN: 'llvm.minnum.f64',
          ca.OP_FMAX: 'llvm.maxnum.f64', ca.OP_COPYSIGN: 'llvm.copysign.f64'}
_TWO_ARGUMENTS = {'atan2', 'pow', 'llvm.minnum.f64', 'llvm.maxnum.f64', 'llvm.copysign.f64'}


class RowFunction:
    """
    A casadi function of scalars, evaluated row by row.

    :param function: the ``casadi.Function`` of ``SX``; its arguments and results are flat arrays
        of their nonzeros, by columns.
    :param is_compiled: whether it is compiled where that is possible, or interpreted by casadi.
    :param is_independent: whether no row goes on from another one.
    :param gathered: names of the arguments whose rows are picked by number.
    """

    def __init__(self, function: Any, is_compiled: bool = True, is_independent: bool = False,
                 gathered: Sequence[str] = ()) -> None:
        """Compile the function, or keep it where there is no compiler."""
        self._function = function
        inputs, outputs = range(function.n_in()), range(function.n_out())
        self.sizes: dict[str, int] = {
            **{function.name_in(i): function.nnz_in(i) for i in inputs},
            **{function.name_out(i): function.nnz_out(i) for i in outputs}}
        self._results = [function.name_out(i) for i in outputs]
        self._gathered = gathered
        self._by_thread = threading.local()
        lanes = LANES if is_independent else 1
        self._code = _compile(function, lanes, gathered) if is_compiled else None

    def __call__(self, arguments: Mapping[str, FloatArray]) -> list[FloatArray]:
        """
        Evaluate rows in memory that is kept for the next time, by each thread its own.

        :param arguments: name -> array of shape (n, size), or (size,) for what is the same in all
            rows: in all calls alike.
        :return: results, shape (n, size) each.
        """
        count = max(len(array) for array in arguments.values() if array.ndim == 2)
        memory: Optional[_Memory] = getattr(self._by_thread, 'memory', None)
        if memory is None or memory.capacity < count:
            memory = self._by_thread.memory = self._memory(count, arguments)
        for name, array in arguments.items():
            if array.ndim == 2:
                memory.arrays[name][:count] = array
            else:
                memory.arrays[name][:] = array
        memory.evaluate.count[0] = count
        memory.evaluate()
        return [memory.arrays[name][:count].copy() for name in self._results]

    def _memory(self, count: int, arguments: Mapping[str, FloatArray]) -> '_Memory':
        """Allocate memory for a number of rows, or some more."""
        capacity = MIN_CAPACITY
        while capacity < count:
            capacity *= 2
        arrays = {name: np.zeros(size if name in arguments and arguments[name].ndim == 1
                                 else (capacity, size)) for name, size in self.sizes.items()}
        return _Memory(arrays, capacity, self.bind(arrays))

    def bind(self, arrays: Mapping[str, FloatArray],
             indices: Optional[IntArray] = None) -> 'BoundRows':
        """
        Prepare evaluations over rows; each call evaluates all of them, in order.

        :param arrays: name of each argument and result -> array of shape (n, size), or (size,) for
            what is the same in all rows. They may be views, also reversed ones, of contiguous
            rows.
        :param indices: those of the rows of gathered arguments, shape (n,).
        """
        rows = [arrays[name] for name in self.sizes]
        count = next((len(array) for name, array in zip(self.sizes, rows)
                      if array.ndim == 2 and name not in self._gathered), 1)
        for name, array in zip(self.sizes, rows):
            _check_rows(name, array, self.sizes[name],
                        len(array) if name in self._gathered else count)
        if self._code is None:
            picked = [indices if name in self._gathered else None for name in self.sizes]
            return BoundRows(functools.partial(_interpret, self._function, rows, picked), count,
                             rows)
        pointed = rows if indices is None else [*rows, indices]
        addresses = (ctypes.c_void_p * len(pointed))(*(
            array.__array_interface__['data'][0] for array in pointed))
        strides = (ctypes.c_int64 * len(rows))(
            *(array.strides[0] // ITEM_SIZE if array.ndim == 2 else 0 for array in rows))
        call = _Call(self._code.address, ctypes.addressof(addresses), ctypes.addressof(strides))
        evaluate = functools.partial(self._code.entry, call.addresses, call.strides)
        return BoundRows(evaluate, count, (self._code, pointed, addresses, strides), call)


class _Call(NamedTuple):
    """Addresses of machine code, and of what it is given besides the number of rows."""

    function: int
    addresses: int
    strides: int


class BoundRows:
    """
    A function that is bound to arrays.

    Attributes: ``count``, the number of rows, from the first one, at least 1, shape (1,): all of
    them, unless another number is put there; ``call``, the ``_Call`` of machine code, None where
    there is none.

    :param evaluate: function of the number of rows, from the first one.
    :param count: number of all rows.
    :param pointed: what machine code points to, and so must live as long as this.
    :param call: see above.
    """

    def __init__(self, evaluate: Callable[[int], Any], count: int, pointed: Any,
                 call: Optional[_Call] = None) -> None:
        """Keep what is bound."""
        self._evaluate = evaluate
        self.count: IntArray = np.array([count], dtype=np.int64)
        self._pointed = pointed
        self.call = call

    def __call__(self) -> None:
        """Evaluate the rows."""
        self._evaluate(self.count.item())


class RowSequence:
    """
    Functions that are bound to arrays, evaluated one after the other by one call.

    :param parts: ``BoundRows`` in their order, and sequences of such.
    """

    def __init__(self, *parts: 'BoundRows | RowSequence') -> None:
        """List the calls."""
        self._parts: list[BoundRows] = []
        for part in parts:
            self._parts += [part] if isinstance(part, BoundRows) else part._parts
        self._code = _sequence_code()
        self._evaluate: Callable[[], Any] = self._evaluate_parts
        calls = [(*part.call, part.count.__array_interface__['data'][0])
                 for part in self._parts if part.call is not None]
        # Of each call the addresses of function, arrays, strides, and number of rows.
        self._calls: IntArray = np.array(calls, dtype=np.int64)
        if self._code is not None and len(calls) == len(self._parts):
            self._evaluate = functools.partial(
                self._code.entry, self._calls.__array_interface__['data'][0], None, len(calls))

    def _evaluate_parts(self) -> None:
        for part in self._parts:
            part()

    def __call__(self) -> None:
        """Evaluate all."""
        self._evaluate()


class _Memory(NamedTuple):
    """Arrays for a number of rows at most, and the evaluation that works on them."""

    arrays: Mapping[str, FloatArray]
    capacity: int
    evaluate: BoundRows


class _Code(NamedTuple):
    """Machine code: the engine that owns it, its entry, and the address of that."""

    engine: Any
    entry: Any
    address: int


def _check_rows(name: str, array: FloatArray, size: int, count: int) -> None:
    shape = (count, size) if array.ndim == 2 else (size,)
    if array.shape != shape or array.dtype != np.float64 or (
            size > 1 and array.strides[-1] != ITEM_SIZE):
        raise ValueError(f'{name}: got shape {array.shape} of {array.dtype}, strides '
                         f'{array.strides}, expected contiguous float64 of shape {shape}')


def _interpret(function: Any, rows: Sequence[FloatArray], picked: Sequence[Optional[IntArray]],
               count: int) -> None:
    """Evaluate rows by casadi."""
    inputs = function.n_in()
    for k in range(count):
        values = [array if array.ndim == 1 else array[k if indices is None else indices[k]]
                  for array, indices in zip(rows, picked)]
        arguments = [ca.DM(function.sparsity_in(i), value)
                     for i, value in enumerate(values[:inputs])]
        for result, output in zip(values[inputs:], function.call(arguments)):
            result[:] = output.nonzeros()


@functools.lru_cache(maxsize=1)
def _llvm() -> Any:
    """Import and prepare LLVM; None where it is missing."""
    try:
        llvm = importlib.import_module('llvmlite.binding')
    except ImportError:
        return None
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    return llvm


def _compile(function: Any, lanes: int, gathered: Sequence[str]) -> Any:
    """Compile a function, or load its machine code; None where there is no compiler."""
    llvm = _llvm()
    if llvm is None:
        return None
    return _assemble(llvm, _translate(function, llvm.llvm_version_info[0], lanes, gathered))


@functools.lru_cache(maxsize=1)
def _sequence_code() -> Any:
    """Compile the calls of a ``RowSequence``; None where there is no compiler."""
    llvm = _llvm()
    if llvm is None:
        return None
    opaque = llvm.llvm_version_info[0] >= FIRST_OPAQUE_VERSION
    pointer, table, function = ('ptr', 'ptr', 'ptr') if opaque else (
        'i64*', 'double**', 'void (double**, i64*, i64)*')
    record = ['function', 'addresses', 'strides', 'count']
    lines = [f'define void @rows({pointer} %calls, {pointer} %unused, i64 %number) {{', 'entry:',
             '  br label %call', 'call:', '  %k = phi i64 [0, %entry], [%k.next, %call]',
             f'  %first = mul i64 %k, {len(record)}']
    for i, name in enumerate(record):
        lines += [f'  %{name}.index = add i64 %first, {i}',
                  f'  %{name}.place = getelementptr i64, {pointer} %calls, i64 %{name}.index',
                  f'  %{name} = load i64, {pointer} %{name}.place']
    lines += [f'  %called = inttoptr i64 %function to {function}',
              f'  %a = inttoptr i64 %addresses to {table}',
              f'  %s = inttoptr i64 %strides to {pointer}',
              f'  %c = inttoptr i64 %count to {pointer}', f'  %rows = load i64, {pointer} %c',
              f'  call void %called({table} %a, {pointer} %s, i64 %rows)',
              '  %k.next = add i64 %k, 1', '  %more = icmp slt i64 %k.next, %number',
              '  br i1 %more, label %call, label %done', 'done:', '  ret void', '}']
    return _assemble(llvm, '\n'.join(lines))


def _assemble(llvm: Any, text: str) -> _Code:
    """Compile a function ``rows`` in LLVM's language, or load its machine code."""
    cpu, features = llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten()
    machine = llvm.Target.from_default_triple().create_target_machine(
        cpu=cpu, features=features, opt=OPTIMIZATION, jit=True)
    key = repr((text, cpu, features, llvm.llvm_version_info, OPTIMIZATION)).encode()
    name = f'{hashlib.sha256(key).hexdigest()}.o'
    folder = user_cache('machine_code')

    def emit() -> bytes:
        module = llvm.parse_assembly(text)
        module.triple = machine.triple
        return machine.emit_object(module)
    code = emit() if folder is None else folder.read_or_make(name, emit)
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(''), machine)
    engine.add_object_file(llvm.object_file.ObjectFileRef.from_data(code))
    engine.finalize_object()
    prototype = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int64)
    address = engine.get_function_address('rows')
    return _Code(engine, prototype(address), address)


def _translate(function: Any, version: int, lanes: int, gathered: Sequence[str]) -> str:
    """Write a loop over rows in LLVM's language, some rows at once."""
    pointer, table = ('ptr', 'ptr') if version >= FIRST_OPAQUE_VERSION else ('double*', 'double**')
    count = function.n_in() + function.n_out()
    head = [f'define void @rows({table} %addresses, i64* %strides, i64 %count) {{'
            if version < FIRST_OPAQUE_VERSION else
            'define void @rows(ptr %addresses, ptr %strides, i64 %count) {', 'entry:',
            '  %last = sub i64 %count, 1']
    strides = 'ptr' if version >= FIRST_OPAQUE_VERSION else 'i64*'
    loop = ['  br label %row', 'row:', '  %k = phi i64 [0, %entry], [%k.next, %row]']
    for lane in range(lanes):
        # Lanes beyond the last row evaluate it once more.
        loop += [f'  %j{lane} = add i64 %k, {lane}',
                 f'  %m{lane} = icmp slt i64 %j{lane}, %last',
                 f'  %r{lane} = select i1 %m{lane}, i64 %j{lane}, i64 %last']
    if gathered:
        head += [f'  %n = getelementptr {pointer}, {table} %addresses, i64 {count}',
                 f'  %n.begin = load {pointer}, {table} %n',
                 f'  %numbers = bitcast {pointer} %n.begin to {strides}']
        for lane in range(lanes):
            loop += [f'  %n{lane} = getelementptr i64, {strides} %numbers, i64 %r{lane}',
                     f'  %g{lane} = load i64, {strides} %n{lane}']
    for i in range(count):
        row = 'g' if i < function.n_in() and function.name_in(i) in gathered else 'r'
        head += [f'  %a{i} = getelementptr {pointer}, {table} %addresses, i64 {i}',
                 f'  %b{i} = load {pointer}, {table} %a{i}',
                 f'  %c{i} = getelementptr i64, {strides} %strides, i64 {i}',
                 f'  %d{i} = load i64, {strides} %c{i}']
        for lane in range(lanes):
            loop += [f'  %o{i}.{lane} = mul i64 %d{i}, %{row}{lane}',
                     f'  %p{i}.{lane} = getelementptr double, {pointer} %b{i}, i64 %o{i}.{lane}']
    translation = _Translation(function, pointer, lanes)
    body = translation.lines()
    end = [f'  %k.next = add i64 %k, {lanes}', '  %more = icmp slt i64 %k.next, %count',
           '  br i1 %more, label %row, label %done', 'done:', '  ret void', '}']
    return '\n'.join([*head, *loop, *body, *end, *translation.declarations()])


class _Translation:
    """Operations of a row, or of some rows in the lanes of vectors, in LLVM's language."""

    def __init__(self, function: Any, pointer: str, lanes: int) -> None:
        self._function = function
        self._pointer = pointer
        self._lanes = lanes
        self._type = 'double' if lanes == 1 else f'<{lanes} x double>'
        # Values by slot of casadi's work vector.
        self._values: dict[int, str] = {}
        self._count = 0
        self._called: set[str] = set()

    def lines(self) -> list[str]:
        """Translate all operations; results are stored last, as they may overlap arguments."""
        function = self._function
        lines: list[str] = []
        stores: list[str] = []
        for k in range(function.n_instructions()):
            operation = function.instruction_id(k)
            outputs = function.instruction_output(k)
            if operation == ca.OP_CONST:
                self._values[outputs[0]] = self._constant(function.instruction_constant(k))
            elif operation == ca.OP_INPUT:
                argument, element = function.instruction_input(k)
                lines += self._load(outputs[0], argument, element)
            elif operation == ca.OP_OUTPUT:
                result, element = outputs
                slot = function.instruction_input(k)[0]
                stores += self._store(slot, function.n_in() + result, element)
            else:
                values = [self._values[slot] for slot in function.instruction_input(k)]
                lines += self._operate(outputs[0], operation, values)
        return lines + stores

    def declarations(self) -> list[str]:
        """Declare all functions that are called."""
        return [f'declare {self._type_of(name)} @{self._name(name)}('
                + ', '.join([self._type_of(name)] * (2 if name in _TWO_ARGUMENTS else 1)) + ')'
                for name in sorted(self._called)]

    def _new(self) -> str:
        self._count += 1
        return f'%v{self._count}'

    def _constant(self, value: float) -> str:
        """Write a number exactly, in all lanes."""
        text = f'0x{np.float64(value).view(np.uint64):016X}'
        if self._lanes == 1:
            return text
        return '<' + ', '.join([f'double {text}'] * self._lanes) + '>'

    def _load(self, slot: int, argument: int, element: int) -> list[str]:
        lines: list[str] = []
        operands: list[str] = []
        for lane in range(self._lanes):
            address, value = self._new(), self._new()
            lines += [f'  {address} = getelementptr double, {self._pointer} '
                      f'%p{argument}.{lane}, i64 {element}',
                      f'  {value} = load double, {self._pointer} {address}']
            operands.append(value)
        joined = self._joined(operands, lines)
        self._values[slot] = joined
        return lines

    def _store(self, slot: int, result: int, element: int) -> list[str]:
        lines: list[str] = []
        for lane, value in enumerate(self._separate(self._values[slot], lines)):
            address = self._new()
            lines += [f'  {address} = getelementptr double, {self._pointer} '
                      f'%p{result}.{lane}, i64 {element}',
                      f'  store double {value}, {self._pointer} {address}']
        return lines

    def _joined(self, values: Sequence[str], lines: list[str]) -> str:
        """Put the numbers of all lanes into one vector."""
        if self._lanes == 1:
            return values[0]
        joined = 'undef'
        for lane, value in enumerate(values):
            following = self._new()
            lines.append(f'  {following} = insertelement {self._type} {joined}, double {value}, '
                         f'i32 {lane}')
            joined = following
        return joined

    def _separate(self, vector: str, lines: list[str]) -> list[str]:
        """Take the numbers of all lanes out of a vector."""
        if self._lanes == 1:
            return [vector]
        values = [self._new() for _ in range(self._lanes)]
        lines += [f'  {value} = extractelement {self._type} {vector}, i32 {lane}'
                  for lane, value in enumerate(values)]
        return values

    def _operate(self, slot: int, operation: int, values: Sequence[str]) -> list[str]:
        result = self._new()
        self._values[slot] = result
        if operation in _BINARY:
            return [f'  {result} = {_BINARY[operation]} contract {self._type} {values[0]}, '
                    f'{values[1]}']
        if operation in _CALLS:
            return self._call(slot, _CALLS[operation], values)
        if operation in _COMPARISONS:
            return self._number(result, f'fcmp {_COMPARISONS[operation]} {self._type} '
                                        f'{values[0]}, {values[1]}')
        return self._other(result, operation, values)

    def _call(self, slot: int, name: str, values: Sequence[str]) -> list[str]:
        """Call a function: those of the processor for all lanes at once, others one by one."""
        self._called.add(name)
        lines: list[str] = []
        kind = self._type_of(name)
        operands = [values] if kind == self._type else list(
            zip(*[self._separate(value, lines) for value in values]))
        results: list[str] = []
        for arguments in operands:
            result = self._new()
            passed = ', '.join(f'{kind} {argument}' for argument in arguments)
            lines.append(f'  {result} = call {kind} @{self._name(name)}({passed})')
            results.append(result)
        self._values[slot] = results[0] if len(results) == 1 else self._joined(results, lines)
        return lines

    def _type_of(self, name: str) -> str:
        return self._type if name.startswith('llvm.') else 'double'

    def _name(self, name: str) -> str:
        """Name of a function; those of LLVM bear their type."""
        if self._lanes == 1 or not name.startswith('llvm.'):
            return name
        return name.replace('.f64', f'.v{self._lanes}f64')

    def _other(self, result: str, operation: int, values: Sequence[str]) -> list[str]:
        kind, first = self._type, values[0]
        simple = {ca.OP_SQ: f'fmul contract {kind} {first}, {first}',
                  ca.OP_TWICE: f'fadd contract {kind} {first}, {first}',
                  ca.OP_NEG: f'fneg {kind} {first}',
                  ca.OP_INV: f'fdiv {kind} {self._constant(1.0)}, {first}',
                  ca.OP_ASSIGN: f'fadd {kind} {first}, {self._constant(-0.0)}'}
        if operation in simple:
            return [f'  {result} = {simple[operation]}']
        zero = self._constant(0.0)
        if operation == ca.OP_NOT:
            return self._number(result, f'fcmp oeq {kind} {first}, {zero}')
        if operation == ca.OP_IF_ELSE_ZERO:
            chosen = self._new()
            return [f'  {chosen} = fcmp une {kind} {first}, {zero}',
                    f'  {result} = select {self._truth} {chosen}, {kind} {values[1]}, '
                    f'{kind} {zero}']
        raise ValueError(f'operation: got number {operation} of casadi, expected one that is '
                         'translated to machine code')

    def _number(self, result: str, comparison: str) -> list[str]:
        """Turn a truth value into 0 or 1."""
        truth = self._new()
        return [f'  {truth} = {comparison}',
                f'  {result} = uitofp {self._truth} {truth} to {self._type}']

    @property
    def _truth(self) -> str:
        return 'i1' if self._lanes == 1 else f'<{self._lanes} x i1>'
