/* The fields of `axisrig.bench.bus.can.frame.Frame`, for the extensions of this room. */

#ifndef AXISRIG_FRAME_H
#define AXISRIG_FRAME_H

#include <Python.h>

enum { DATA_BYTES_MAX = 8 };

typedef struct {
    long long can_id;
    const unsigned char *data;
    int size, extended, remote, dlc;
} Fields;

/* Reads a frame; `data` is valid as long as the frame is. -1 with an exception. */
static inline int read_frame(PyObject *frame, Fields *fields)
{
    if (!PyTuple_Check(frame) || PyTuple_GET_SIZE(frame) != 5
        || !PyBytes_Check(PyTuple_GET_ITEM(frame, 1))
        || PyBytes_GET_SIZE(PyTuple_GET_ITEM(frame, 1)) > DATA_BYTES_MAX) {
        PyErr_SetString(PyExc_TypeError, "no frame");
        return -1;
    }
    PyObject *data = PyTuple_GET_ITEM(frame, 1);
    fields->can_id = PyLong_AsLongLong(PyTuple_GET_ITEM(frame, 0));
    fields->data = (const unsigned char *)PyBytes_AS_STRING(data);
    fields->size = (int)PyBytes_GET_SIZE(data);
    fields->extended = PyObject_IsTrue(PyTuple_GET_ITEM(frame, 2));
    fields->remote = PyObject_IsTrue(PyTuple_GET_ITEM(frame, 3));
    fields->dlc = (int)PyLong_AsLong(PyTuple_GET_ITEM(frame, 4));
    return PyErr_Occurred() ? -1 : 0;
}

#endif
