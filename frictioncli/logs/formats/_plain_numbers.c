/* Parser of delimited text that holds nothing but plain numbers.
 *
 * Anything else (quotes, blanks, words, rows with another number of fields, more digits than a
 * double holds) makes the whole text "not plain", and pyarrow parses it instead. Damaged logs are
 * therefore never handled here.
 *
 * A number m * 10^e with m <= 2^53 and |e| <= 22 needs one operation on two doubles that are both
 * exact, so it is rounded once and correctly (Clinger 1990, https://doi.org/10.1145/93542.93557).
 */
#define PY_SSIZE_T_CLEAN
#define Py_LIMITED_API 0x030B0000
#include <Python.h>

#include <float.h>
#include <math.h>
#include <stdint.h>

#if FLT_EVAL_METHOD != 0
#error "doubles must be rounded after each operation"
#endif

#define MOST_DIGITS 19 /* this many fit into 64 bits */
#define LARGEST_POWER 22
#define LARGEST_UP 18 /* keeps results below 9.9e34, which marks a missing value in DIAdem */
#define LARGEST_EXACT ((uint64_t)1 << 53)

static const double POWERS[LARGEST_POWER + 1] = {
    1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
    1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

typedef struct {
    char delimiter, decimal;
    const char *wanted; /* for each field, whether it is to be read */
    Py_ssize_t fields, rows;
} Form;

/* Texts end with a zero byte, which is not a digit, so no loop has to check for the end. */
static const char *digits(const char *at, uint64_t *number) {
    for (unsigned digit; (digit = (unsigned char)*at - '0') <= 9; at++)
        *number = *number * 10 + digit;
    return at;
}

/* Returns the end of the number that begins at `at`, or NULL if it is not plain. */
static const char *number(const char *at, char decimal, double *value) {
    int negative = *at == '-';
    const char *start = at + negative;
    uint64_t mantissa = 0;
    at = digits(start, &mantissa);
    if (at == start) return NULL;
    Py_ssize_t count = at - start, power = 0;
    if (*at == decimal) {
        const char *fraction = at + 1;
        at = digits(fraction, &mantissa);
        power = fraction - at;
        count -= power;
    }
    if (count > MOST_DIGITS || mantissa > LARGEST_EXACT) return NULL;
    if (*at == 'e' || *at == 'E') {
        int down = *++at == '-';
        start = at += down || *at == '+';
        uint64_t exponent = 0;
        at = digits(start, &exponent);
        if (at == start || at - start > 3) return NULL;
        power += down ? -(Py_ssize_t)exponent : (Py_ssize_t)exponent;
    }
    if (power < -LARGEST_POWER || power > LARGEST_UP) return NULL;
    double size = power < 0 ? (double)mantissa / POWERS[-power] : (double)mantissa * POWERS[power];
    *value = negative ? -size : size;
    return at;
}

/* Returns the end of a field that is not to be read, or NULL if it is not plain. */
static const char *passed_over(const char *at, const char *end, char delimiter) {
    while (at < end && *at != delimiter && *at != '\n' && *at != '\r')
        if (*at++ == '"') return NULL;
    return at;
}

/* Fills `out` column by column; returns whether all of the text is plain. */
static int filled(const char *at, const char *end, const Form *form, double *out) {
    for (Py_ssize_t row = 0; row < form->rows; row++) {
        double *cell = out + row;
        for (Py_ssize_t field = 0; field < form->fields; field++) {
            if (field && *at++ != form->delimiter) return 0;
            if (!form->wanted[field]) {
                at = passed_over(at, end, form->delimiter);
            } else {
                *cell = NAN; /* an empty field */
                if (*at != form->delimiter && *at != '\n' && *at != '\r')
                    at = number(at, form->decimal, cell);
                cell += form->rows;
            }
            if (!at) return 0;
        }
        at += *at == '\r' && at[1] == '\n';
        if (*at == '\n')
            at++;
        else if (at != end)
            return 0;
    }
    return at == end;
}

static PyObject *columns(PyObject *Py_UNUSED(module), PyObject *args) {
    PyObject *text, *result = NULL;
    Py_buffer wanted, out;
    int delimiter, decimal;
    if (!PyArg_ParseTuple(args, "Siiy*w*:columns", &text, &delimiter, &decimal, &wanted, &out))
        return NULL;
    Form form = {(char)delimiter, (char)decimal, wanted.buf, wanted.len, 0};
    Py_ssize_t asked = 0;
    for (Py_ssize_t field = 0; field < form.fields; field++) asked += form.wanted[field] != 0;
    Py_ssize_t row_bytes = asked * (Py_ssize_t)sizeof(double);
    /* checked before they are cast: 256 would become the zero byte that ends the text */
    int known = delimiter > 0 && delimiter < 128 && decimal > 0 && decimal < 128 &&
                delimiter != '\n' && delimiter != '\r' && decimal != '\n' && decimal != '\r';
    if (!known || form.fields < 2 || !asked || out.len % row_bytes) {
        PyErr_SetString(PyExc_ValueError,
                        "expected characters, two fields or more, and room for whole rows");
    } else {
        form.rows = out.len / row_bytes;
        const char *start = PyBytes_AsString(text);
        const char *end = start + PyBytes_Size(text);
        int plain;
        Py_BEGIN_ALLOW_THREADS
        plain = filled(start, end, &form, out.buf);
        Py_END_ALLOW_THREADS
        result = PyBool_FromLong(plain);
    }
    PyBuffer_Release(&wanted);
    PyBuffer_Release(&out);
    return result;
}

#define COUNTED 255 /* bytes counted in a one-byte counter, so that the loop is vectorised */

static PyObject *line_feeds(PyObject *Py_UNUSED(module), PyObject *text) {
    char *at;
    Py_ssize_t left, count = 0;
    if (PyBytes_AsStringAndSize(text, &at, &left) < 0) return NULL;
    Py_BEGIN_ALLOW_THREADS
    while (left) {
        Py_ssize_t some = left < COUNTED ? left : COUNTED;
        unsigned char found = 0;
        for (Py_ssize_t i = 0; i < some; i++) found += at[i] == '\n';
        count += found;
        at += some;
        left -= some;
    }
    Py_END_ALLOW_THREADS
    return PyLong_FromSsize_t(count);
}

static PyMethodDef METHODS[] = {
    {"columns", columns, METH_VARARGS,
     "columns(text, delimiter, decimal, wanted, out): fill out, tell whether all was plain"},
    {"line_feeds", line_feeds, METH_O, "line_feeds(text): count them"},
    {NULL, NULL, 0, NULL}};

static struct PyModuleDef MODULE = {PyModuleDef_HEAD_INIT, "_plain_numbers", NULL, 0, METHODS,
                                    NULL, NULL, NULL, NULL};

PyMODINIT_FUNC PyInit__plain_numbers(void) { return PyModuleDef_Init(&MODULE); }
