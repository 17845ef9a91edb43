/* Records of blocks of frames in C, for the compiled build: what `FrameHash`, `BlfLog` and
   `LoadMeter` of this room do in Python, with the same bytes and numbers.

   A block is a list of `axisrig.bench.bus.journal.Entry`. */

#define PY_SSIZE_T_CLEAN
#include <stdint.h>
#include <string.h>

#include "_frame.h"

#define EXTENDED_FLAG 0x80000000u

static void put(unsigned char **place, unsigned long long value, int bytes)
{
    for (int i = 0; i < bytes; i++)
        *(*place)++ = (unsigned char)(value >> 8 * i);
}

/* The fields of entry `i` of a block: its time, its segment, whether it is an error frame. */
static int read_entry(PyObject *block, Py_ssize_t i, long long *time_ns, PyObject **segment,
                      Fields *fields, int *is_error)
{
    PyObject *entry = PyList_GET_ITEM(block, i);
    if (!PyTuple_Check(entry) || PyTuple_GET_SIZE(entry) != 4) {
        PyErr_SetString(PyExc_TypeError, "no entry of a journal");
        return -1;
    }
    *time_ns = PyLong_AsLongLong(PyTuple_GET_ITEM(entry, 0));
    *segment = PyTuple_GET_ITEM(entry, 1);
    *is_error = PyObject_IsTrue(PyTuple_GET_ITEM(entry, 3));
    return PyErr_Occurred() ? -1 : read_frame(PyTuple_GET_ITEM(entry, 2), fields);
}

/* Puts the data of a frame, filled up to 8 bytes. */
static void put_data(unsigned char **place, const Fields *fields)
{
    memset(*place, 0, DATA_BYTES_MAX);
    memcpy(*place, fields->data, (size_t)fields->size);
    *place += DATA_BYTES_MAX;
}

/* hash_records(block, names): names: segment -> bytes of its name, with their length before it */
static PyObject *hash_records(PyObject *Py_UNUSED(module), PyObject *args)
{
    PyObject *block, *names, *segment;
    if (!PyArg_ParseTuple(args, "O!O!:hash_records", &PyList_Type, &block, &PyDict_Type, &names))
        return NULL;
    Py_ssize_t count = PyList_GET_SIZE(block);
    unsigned char *bytes = PyMem_Malloc((size_t)count * (22 + 256) + 1), *place = bytes;
    if (!bytes)
        return PyErr_NoMemory();
    for (Py_ssize_t i = 0; i < count; i++) {
        long long time_ns;
        Fields frame;
        int is_error;
        if (read_entry(block, i, &time_ns, &segment, &frame, &is_error) < 0)
            goto failed;
        PyObject *name = PyDict_GetItemWithError(names, segment);
        if (!name || !PyBytes_Check(name) || PyBytes_GET_SIZE(name) > 256) {
            if (!PyErr_Occurred())
                PyErr_Format(PyExc_KeyError, "segment %R", segment);
            goto failed;
        }
        put(&place, (unsigned long long)time_ns, 8);
        memcpy(place, PyBytes_AS_STRING(name), (size_t)PyBytes_GET_SIZE(name));
        place += PyBytes_GET_SIZE(name);
        put(&place, (unsigned long long)frame.can_id, 4);
        put(&place, (unsigned)(frame.extended | frame.remote << 1 | is_error << 2), 1);
        put(&place, (unsigned)frame.dlc, 1);
        put_data(&place, &frame);
    }
    PyObject *result = PyBytes_FromStringAndSize((char *)bytes, place - bytes);
    PyMem_Free(bytes);
    return result;
failed:
    PyMem_Free(bytes);
    return NULL;
}

/* blf_objects(block, first, numbers, head): data and remote frames from entry `first` on, up to an
   error frame. Returns their bytes, and the number of the entry after them.
   Source: can/io/blf.py of python-can: head of 24 bytes, then time, channel, flags, dlc, identifier,
   data. */
static PyObject *blf_objects(PyObject *Py_UNUSED(module), PyObject *args)
{
    enum { HEAD = 24, OBJECT = 48, REMOTE = 0x80 };
    PyObject *block, *numbers, *segment;
    Py_ssize_t first, head_size;
    const char *head;
    if (!PyArg_ParseTuple(args, "O!nO!y#:blf_objects", &PyList_Type, &block, &first, &PyDict_Type,
                          &numbers, &head, &head_size))
        return NULL;
    Py_ssize_t count = PyList_GET_SIZE(block), i;
    if (first < 0 || first > count || head_size != HEAD) {
        PyErr_SetString(PyExc_ValueError, "first entry or head of an object");
        return NULL;
    }
    unsigned char *bytes = PyMem_Malloc((size_t)(count - first) * OBJECT + 1), *place = bytes;
    if (!bytes)
        return PyErr_NoMemory();
    for (i = first; i < count; i++) {
        long long time_ns;
        Fields frame;
        int is_error;
        if (read_entry(block, i, &time_ns, &segment, &frame, &is_error) < 0)
            goto failed;
        if (is_error)
            break;
        PyObject *number = PyDict_GetItemWithError(numbers, segment);
        long channel = number ? PyLong_AsLong(number) : -1;
        if (channel < 0) {
            if (!PyErr_Occurred())
                PyErr_Format(PyExc_KeyError, "segment %R", segment);
            goto failed;
        }
        memcpy(place, head, HEAD);
        place += HEAD;
        /* Over seconds as a float and back, as python-can does */
        put(&place, (unsigned long long)((double)time_ns / 1e9 * 1e9), 8);
        put(&place, (unsigned long long)channel, 2);
        put(&place, frame.remote ? REMOTE : 0, 1);
        put(&place, (unsigned)frame.dlc, 1);
        put(&place, (unsigned long long)frame.can_id | (frame.extended ? EXTENDED_FLAG : 0), 4);
        put_data(&place, &frame);
    }
    PyObject *result = Py_BuildValue("(y#n)", (char *)bytes, place - bytes, i);
    PyMem_Free(bytes);
    return result;
failed:
    PyMem_Free(bytes);
    return NULL;
}

/* add_load(passed, busy_ns, worst_delay_ns, window_ns, begin_ns): busy_ns: array("Q") of windows from
   begin_ns on, long enough; worst_delay_ns: identifier (bit 31 set on 29-bit ones) -> ns. Returns the bits of all frames. */
static PyObject *add_load(PyObject *Py_UNUSED(module), PyObject *args)
{
    PyObject *passed, *windows, *worst;
    long long window_ns, begin_ns, bits_sum = 0;
    if (!PyArg_ParseTuple(args, "O!OO!LL:add_load", &PyList_Type, &passed, &windows, &PyDict_Type,
                          &worst, &window_ns, &begin_ns))
        return NULL;
    Py_buffer view;
    if (PyObject_GetBuffer(windows, &view, PyBUF_WRITABLE | PyBUF_FORMAT | PyBUF_ND) < 0)
        return NULL;
    if (view.itemsize != 8 || strcmp(view.format, "Q") || window_ns <= 0) {
        PyErr_SetString(PyExc_TypeError, "busy_ns is an array of 8-byte integers");
        goto failed;
    }
    uint64_t *busy_ns = view.buf;
    long long count = view.len / view.itemsize;
    for (Py_ssize_t i = 0; i < PyList_GET_SIZE(passed); i++) {
        PyObject *one = PyList_GET_ITEM(passed, i);
        if (!PyTuple_Check(one) || PyTuple_GET_SIZE(one) != 6) {
            PyErr_SetString(PyExc_TypeError, "passed holds tuples of six");
            goto failed;
        }
        long long start_ns = PyLong_AsLongLong(PyTuple_GET_ITEM(one, 0)) - begin_ns;
        long long end_ns = PyLong_AsLongLong(PyTuple_GET_ITEM(one, 1)) - begin_ns;
        bits_sum += PyLong_AsLongLong(PyTuple_GET_ITEM(one, 2));
        int extended = PyObject_IsTrue(PyTuple_GET_ITEM(one, 4));
        long long delay_ns = PyLong_AsLongLong(PyTuple_GET_ITEM(one, 5));
        if (PyErr_Occurred())
            goto failed;
        if (start_ns < 0 || end_ns <= start_ns || (end_ns - 1) / window_ns >= count) {
            PyErr_SetString(PyExc_IndexError, "a frame outside the windows");
            goto failed;
        }
        while (start_ns < end_ns) {
            long long window = start_ns / window_ns, border_ns = (window + 1) * window_ns;
            long long until_ns = end_ns < border_ns ? end_ns : border_ns;
            busy_ns[window] += (uint64_t)(until_ns - start_ns);
            start_ns = until_ns;
        }
        PyObject *key = Py_NewRef(PyTuple_GET_ITEM(one, 3));
        if (extended)
            Py_SETREF(key, PyLong_FromLongLong(PyLong_AsLongLong(key) | EXTENDED_FLAG));
        PyObject *known = key ? PyDict_GetItemWithError(worst, key) : NULL;
        int status = PyErr_Occurred() ? -1 : 0;
        if (status == 0 && delay_ns >= (known ? PyLong_AsLongLong(known) : 0))
            status = PyDict_SetItem(worst, key, PyTuple_GET_ITEM(one, 5));
        Py_XDECREF(key);
        if (status < 0)
            goto failed;
    }
    PyBuffer_Release(&view);
    return PyLong_FromLongLong(bits_sum);
failed:
    PyBuffer_Release(&view);
    return NULL;
}

static PyMethodDef functions[] = {
    {"hash_records", hash_records, METH_VARARGS, "Bytes of a block for the frame hash."},
    {"blf_objects", blf_objects, METH_VARARGS, "Objects of a BLF file for a block."},
    {"add_load", add_load, METH_VARARGS, "Add frames to the windows of a load meter."},
    {NULL},
};

static PyModuleDef module = {
    PyModuleDef_HEAD_INIT,
    .m_name = "axisrig.bench.bus.can._records",
    .m_doc = "Records of blocks of frames in C.",
    .m_size = -1,
    .m_methods = functions,
};

PyMODINIT_FUNC PyInit__records(void)
{
    return PyModule_Create(&module);
}
