/* Sums over runs of samples in one angle bin, in a single pass.
 *
 * Samples are added one after the other, so that the numbers are those of numpy.bincount to the
 * last bit: what was built decides how long it takes, never what comes out.
 */
#define PY_SSIZE_T_CLEAN
#define Py_LIMITED_API 0x030B0000
#include <Python.h>

#include <math.h>
#include <stdint.h>

#if defined(__FLT_EVAL_METHOD__) && __FLT_EVAL_METHOD__ != 0
#error "doubles must be rounded after each operation"
#endif

#define MARGIN 1e-9 /* of a bin: nearer to an edge the quotient decides */

typedef struct {
    const double *position, *torque, *load, *time;
} Samples;

typedef struct {
    double *bin, *position, *torque, *load, *time;
    int64_t *count;
} Runs;

/* Adds the runs of samples `at` to `stop` behind run `run`; returns the number of runs then. */
static Py_ssize_t followed(int64_t at, int64_t stop, double width, const Samples *in, Runs *out,
                           Py_ssize_t run) {
    for (; at < stop; run++) {
        double bin = floor(in->position[at] / width);
        double margin = MARGIN * width * (fabs(bin) + 1);
        double low = bin * width + margin, high = (bin + 1) * width - margin;
        double position = 0, torque = 0, load = 0, time = 0;
        int loaded = !isnan(in->load[at]);
        int64_t first = at;
        do {
            position += in->position[at];
            torque += in->torque[at];
            time += in->time[at];
            if (loaded) load += in->load[at];
            at++;
        } while (at < stop && ((in->position[at] > low && in->position[at] < high) ||
                               floor(in->position[at] / width) == bin));
        out->bin[run] = bin;
        out->count[run] = at - first;
        out->position[run] = position;
        out->torque[run] = torque;
        out->load[run] = loaded ? load : NAN;
        out->time[run] = time;
    }
    return run;
}

static PyObject *runs(PyObject *Py_UNUSED(module), PyObject *args) {
    Py_buffer position, torque, load, time, start, stop, sums, count, end;
    double width;
    if (!PyArg_ParseTuple(args, "y*y*y*y*y*y*dw*w*w*:runs", &position, &torque, &load, &time,
                          &start, &stop, &width, &sums, &count, &end))
        return NULL;
    Py_ssize_t samples = position.len / (Py_ssize_t)sizeof(double);
    Py_ssize_t segments = start.len / (Py_ssize_t)sizeof(int64_t);
    Py_ssize_t room = count.len / (Py_ssize_t)sizeof(int64_t);
    const int64_t *from = start.buf, *to = stop.buf;
    int right = torque.len == position.len && load.len == position.len &&
                time.len == position.len && stop.len == start.len && end.len == start.len &&
                sums.len == 5 * count.len && width > 0;
    int64_t together = 0;
    for (Py_ssize_t segment = 0; right && segment < segments; segment++) {
        right = from[segment] >= 0 && from[segment] < to[segment] && to[segment] <= samples;
        if (right) together += to[segment] - from[segment];
    }
    if (right && together <= room) {
        Samples in = {position.buf, torque.buf, load.buf, time.buf};
        double *column = sums.buf;
        Runs out = {column,           column + room,     column + 2 * room,
                    column + 3 * room, column + 4 * room, count.buf};
        int64_t *last = end.buf;
        Py_BEGIN_ALLOW_THREADS
        Py_ssize_t run = 0;
        for (Py_ssize_t segment = 0; segment < segments; segment++)
            last[segment] = run = followed(from[segment], to[segment], width, &in, &out, run);
        Py_END_ALLOW_THREADS
    } else {
        right = 0;
        PyErr_SetString(PyExc_ValueError, "expected arrays of one length and spans inside them");
    }
    Py_buffer *all[] = {&position, &torque, &load, &time, &start, &stop, &sums, &count, &end};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) PyBuffer_Release(all[i]);
    if (!right) return NULL;
    Py_RETURN_NONE;
}

static PyMethodDef METHODS[] = {
    {"runs", runs, METH_VARARGS,
     "runs(position, torque, load, time, start, stop, width, sums, count, end): fill the last 3"},
    {NULL, NULL, 0, NULL}};

static struct PyModuleDef MODULE = {PyModuleDef_HEAD_INIT, "_bin_runs", NULL, 0, METHODS,
                                    NULL, NULL, NULL, NULL};

PyMODINIT_FUNC PyInit__bin_runs(void) { return PyModuleDef_Init(&MODULE); }
