/* `axisrig.bench.bus.can.line.BusLine` in C, for the compiled build.

   The line goes from frame to frame by itself while nothing disturbs it; all else it leaves to its
   segment, in Python. Members, order of events and values are those of the Python class: the tests
   drive both with the same random traffic, and compare every shipped run.

   A frame is `axisrig.bench.bus.can.frame.Frame`, a request and the frame on the line are the tuples of
   `axisrig.bench.bus.can.controller.Request` and `axisrig.bench.bus.can.line.Current`. */

#define PY_SSIZE_T_CLEAN
#include <_scheduler.h>
#include <structmember.h>

#include "_frame.h"

enum { IFS_BITS = 3, TAIL_BITS = 10, CRC_BITS = 15, CRC_POLYNOMIAL = 0x4599 };

static const AxisrigScheduler *scheduler_api;
static PyTypeObject *frame_type;          /* axisrig.bench.bus.can.frame.Frame */
static long ARBITRATION, DELIVERY;        /* axisrig.kernel.time.clock.Phase */
static PyObject *text_drain, *text_pending, *text_take, *text_direct, *text_by_id, *text_heard;
static PyObject *text_receive_own_messages, *text_deliver;

/* --- length of a frame ----------------------------------------------------------------------- */

/* Last bit on the wire and how often it was there in a row, as 4 * bit + times - 1; bits with stuff
   bits; check sum in the lowest 15 bits. */
typedef struct {
    int state, bits;
    unsigned crc;
} Coder;

/* After the start of frame, one dominant bit; it leaves the check sum at 0. */
static const Coder BEGIN = {.state = 0, .bits = 1};

static unsigned char stuffed_by[8][256], state_after[8][256];
static unsigned short crc_of[256];

static void send_bits(Coder *coder, unsigned value, int width)
{
    for (int place = width - 1; place >= 0; place--) {
        int bit = (int)(value >> place & 1);
        coder->crc = (coder->crc << 1)
                     ^ ((coder->crc >> (CRC_BITS - 1) & 1) ^ (unsigned)bit ? CRC_POLYNOMIAL : 0);
        coder->bits++;
        if (coder->state >> 2 != bit)
            coder->state = 4 * bit;
        else if ((coder->state & 3) < 3)
            coder->state++;
        else { /* the fifth: the bit that is stuffed begins a new row */
            coder->state = 4 * (1 - bit);
            coder->bits++;
        }
    }
}

/* As `send_bits` of 8 bits. */
static void send_byte(Coder *coder, unsigned byte)
{
    coder->crc = coder->crc << 8 ^ crc_of[(coder->crc >> (CRC_BITS - 8) ^ byte) & 0xFF];
    coder->bits += 8 + stuffed_by[coder->state][byte];
    coder->state = state_after[coder->state][byte];
}

static void fill_tables(void)
{
    for (unsigned byte = 0; byte < 256; byte++)
        for (int state = 0; state < 8; state++) {
            Coder coder = {.state = state};
            send_bits(&coder, byte, 8);
            stuffed_by[state][byte] = (unsigned char)(coder.bits - 8);
            state_after[state][byte] = (unsigned char)coder.state;
            crc_of[byte] = (unsigned short)(coder.crc & 0x7FFF);
        }
}

/* Source: Robert Bosch GmbH, CAN Specification 2.0 (1991), part A 3.1.1 and 5, part B. */
static int frame_length(const Fields *frame)
{
    Coder coder = BEGIN;
    if (frame->extended) {
        send_bits(&coder, (unsigned)(frame->can_id >> 18) << 2 | 3, 13);
        send_bits(&coder, (unsigned)(frame->can_id & 0x3FFFF) << 1 | (unsigned)frame->remote, 19);
    } else {
        send_bits(&coder, (unsigned)frame->can_id << 1 | (unsigned)frame->remote, 12);
    }
    send_bits(&coder, (unsigned)frame->dlc, 6); /* with the two reserved bits */
    for (int i = 0; i < frame->size; i++)
        send_byte(&coder, frame->data[i]);
    unsigned crc = coder.crc & 0x7FFF;
    send_byte(&coder, crc >> 7);
    send_bits(&coder, crc & 0x7F, 7);
    return coder.bits + TAIL_BITS + IFS_BITS;
}

static PyObject *frame_bits(PyObject *Py_UNUSED(module), PyObject *frame)
{
    Fields fields;
    if (read_frame(frame, &fields) < 0)
        return NULL;
    return PyLong_FromLong(frame_length(&fields));
}

/* --- the line -------------------------------------------------------------------------------- */

typedef struct {
    PyObject *pending, *take;
} Queue;

typedef struct {
    PyObject_HEAD
    PyObject *segment, *name, *scheduler, *journal, *entries, *passed, *observers, *sequence;
    PyObject *arbitrate, *end_of_frame; /* bound methods of this line, for the scheduler */
    PyObject *live;                     /* tuple of ports; `queues` has theirs, in that order */
    Queue *queues;
    Py_ssize_t queue_count;
    long long *duration_ns;
    Py_ssize_t duration_count, block_frames;
    PyObject *current, *end;
    long long free_ns;
    char is_idle, is_undisturbed;
} Line;

static long long now_of(const Line *self)
{
    return scheduler_api->now_ns(self->scheduler);
}

/* Makes a tuple and takes over the references; NULL with an exception when one of them is NULL. */
static PyObject *tuple_of(PyObject *const *items, Py_ssize_t count)
{
    int is_whole = 1;
    for (Py_ssize_t i = 0; i < count; i++)
        is_whole &= items[i] != NULL;
    PyObject *made = is_whole ? PyTuple_New(count) : NULL;
    for (Py_ssize_t i = 0; i < count; i++) {
        if (made)
            PyTuple_SET_ITEM(made, i, items[i]);
        else
            Py_XDECREF(items[i]);
    }
    if (!made && !PyErr_Occurred())
        PyErr_SetString(PyExc_RuntimeError, "a part of a request or frame is missing");
    return made;
}

static PyObject *done(PyObject *result)
{
    if (!result)
        return NULL;
    Py_DECREF(result);
    Py_RETURN_NONE;
}

static PyObject *ask_segment(Line *self, const char *method)
{
    return done(PyObject_CallMethod(self->segment, method, NULL));
}

static int duration_of(const Line *self, long bits, long long *ns)
{
    if (bits < 0 || bits >= self->duration_count) {
        PyErr_Format(PyExc_ValueError, "%ld bits on the line", bits);
        return -1;
    }
    *ns = self->duration_ns[bits];
    return 0;
}

/* Plans an arbitration. */
static int plan_arbitration(Line *self, long long time_ns)
{
    PyObject *event = scheduler_api->call_at(self->scheduler, time_ns, ARBITRATION, self->arbitrate);
    if (!event)
        return -1;
    Py_DECREF(event);
    return 0;
}

static int wake(Line *self)
{
    if (!self->is_idle)
        return 0;
    self->is_idle = 0;
    long long now_ns = now_of(self);
    return plan_arbitration(self, self->free_ns > now_ns ? self->free_ns : now_ns);
}

static PyObject *line_wake(Line *self, PyObject *Py_UNUSED(none))
{
    if (wake(self) < 0)
        return NULL;
    Py_RETURN_NONE;
}

/* request_data(push, can_id, data): 11 bits, up to 8 bytes of data */
static PyObject *line_request_data(Line *self, PyObject *const *args, Py_ssize_t count)
{
    if (count != 3) {
        PyErr_SetString(PyExc_TypeError, "request_data() takes push, can_id and data");
        return NULL;
    }
    long long can_id = PyLong_AsLongLong(args[1]);
    if (can_id == -1 && PyErr_Occurred())
        return NULL;
    PyObject *data = PyBytes_CheckExact(args[2]) ? Py_NewRef(args[2]) : PyBytes_FromObject(args[2]);
    if (!data)
        return NULL;
    Py_ssize_t size = PyBytes_GET_SIZE(data);
    if (size > DATA_BYTES_MAX) {
        PyErr_Format(PyExc_ValueError, "%zd data bytes in a classical CAN frame", size);
        Py_DECREF(data);
        return NULL;
    }
    /* A named tuple without its constructor */
    PyObject *frame = frame_type->tp_alloc(frame_type, 5);
    if (!frame) {
        Py_DECREF(data);
        return NULL;
    }
    PyTuple_SET_ITEM(frame, 0, Py_NewRef(args[1]));
    PyTuple_SET_ITEM(frame, 1, data);
    PyTuple_SET_ITEM(frame, 2, Py_NewRef(Py_False));
    PyTuple_SET_ITEM(frame, 3, Py_NewRef(Py_False));
    PyTuple_SET_ITEM(frame, 4, PyLong_FromSsize_t(size));
    PyObject *items[] = {
        PyLong_FromLongLong(can_id << 21),
        PyIter_Next(self->sequence),
        PyLong_FromLongLong(now_of(self)),
        PyLong_FromLong(0), /* the attempt */
        frame,
    };
    PyObject *request = tuple_of(items, 5);
    if (!request)
        return NULL;
    PyObject *pushed = PyObject_CallOneArg(args[0], request);
    Py_DECREF(request);
    if (!pushed)
        return NULL;
    Py_DECREF(pushed);
    if (wake(self) < 0)
        return NULL;
    Py_RETURN_NONE;
}

/* Returns whether a queue has requests, and the arbitration key of the first one; -1 = exception. */
static int first_key(const Queue *queue, long long *key)
{
    Py_ssize_t size = PyObject_Size(queue->pending);
    if (size <= 0)
        return (int)size;
    PyObject *request = PySequence_GetItem(queue->pending, 0);
    if (!request)
        return -1;
    if (!PyTuple_Check(request) || PyTuple_GET_SIZE(request) != 5) {
        PyErr_SetString(PyExc_TypeError, "no request in a transmit queue");
        Py_DECREF(request);
        return -1;
    }
    *key = PyLong_AsLongLong(PyTuple_GET_ITEM(request, 0));
    Py_DECREF(request);
    return *key == -1 && PyErr_Occurred() ? -1 : 1;
}

static PyObject *line_arbitrate(Line *self, PyObject *Py_UNUSED(none))
{
    if (!self->is_undisturbed)
        return ask_segment(self, "arbitrate");
    Py_ssize_t winner = -1;
    long long lowest = 0, key = 0;
    int is_collision = 0;
    for (Py_ssize_t i = 0; i < self->queue_count; i++) {
        int has_any = first_key(&self->queues[i], &key);
        if (has_any < 0)
            return NULL;
        if (!has_any)
            continue;
        if (winner < 0 || key < lowest) {
            winner = i;
            lowest = key;
            is_collision = 0;
        } else if (key == lowest) {
            is_collision = 1;
        }
    }
    if (winner < 0) {
        self->is_idle = 1;
        Py_RETURN_NONE;
    }
    if (is_collision)
        return ask_segment(self, "arbitrate");
    PyObject *port = Py_NewRef(PyTuple_GET_ITEM(self->live, winner));
    PyObject *request = PyObject_CallNoArgs(self->queues[winner].take);
    if (!request) {
        Py_DECREF(port);
        return NULL;
    }
    Fields fields;
    long long now_ns = now_of(self), span_ns;
    if (read_frame(PyTuple_GET_ITEM(request, 4), &fields) < 0) {
        Py_DECREF(port);
        Py_DECREF(request);
        return NULL;
    }
    int bits = frame_length(&fields) - IFS_BITS;
    PyObject *items[] = {
        port, request, PyLong_FromLongLong(now_ns), PyLong_FromLong(bits), Py_NewRef(Py_None),
    };
    PyObject *current = tuple_of(items, 5);
    if (!current || duration_of(self, bits, &span_ns) < 0) {
        Py_XDECREF(current);
        return NULL;
    }
    Py_XSETREF(self->current, current);
    PyObject *end =
        scheduler_api->call_at(self->scheduler, now_ns + span_ns, DELIVERY, self->end_of_frame);
    if (!end)
        return NULL;
    Py_XSETREF(self->end, end);
    Py_RETURN_NONE;
}

static int book(Line *self, PyObject *current, long long free_ns)
{
    PyObject *request = PyTuple_GET_ITEM(current, 1), *frame = PyTuple_GET_ITEM(request, 4);
    long long start_ns = PyLong_AsLongLong(PyTuple_GET_ITEM(current, 2));
    long long requested_ns = PyLong_AsLongLong(PyTuple_GET_ITEM(request, 2));
    long bits = PyLong_AsLong(PyTuple_GET_ITEM(current, 3));
    if (PyErr_Occurred())
        return -1;
    Py_XSETREF(self->current, Py_NewRef(Py_None));
    self->free_ns = free_ns;
    PyObject *now = PyLong_FromLongLong(now_of(self));
    PyObject *items[] = {
        Py_NewRef(PyTuple_GET_ITEM(current, 2)),
        PyLong_FromLongLong(free_ns),
        PyLong_FromLong(bits + IFS_BITS),
        Py_NewRef(PyTuple_GET_ITEM(frame, 0)),
        Py_NewRef(PyTuple_GET_ITEM(frame, 2)),
        PyLong_FromLongLong(start_ns - requested_ns),
    };
    PyObject *passed = tuple_of(items, 6);
    PyObject *entry = now ? PyTuple_Pack(4, now, self->name, frame, Py_False) : NULL;
    int status = -1;
    if (!passed || !entry || PyList_Append(self->passed, passed) < 0
        || PyList_Append(self->entries, entry) < 0)
        goto end;
    if (PyList_GET_SIZE(self->entries) >= self->block_frames) {
        PyObject *drained = PyObject_CallMethodNoArgs(self->journal, text_drain);
        if (!drained)
            goto end;
        Py_DECREF(drained);
    }
    status = 0;
    for (Py_ssize_t i = 0; status == 0 && i < PyList_GET_SIZE(self->observers); i++) {
        PyObject *observer = Py_NewRef(PyList_GET_ITEM(self->observers, i));
        PyObject *args[] = {now, self->name, frame, Py_False};
        PyObject *seen = PyObject_Vectorcall(observer, args, 4, NULL);
        status = seen ? 0 : -1;
        Py_XDECREF(seen);
        Py_DECREF(observer);
    }
end:
    Py_XDECREF(now);
    Py_XDECREF(passed);
    Py_XDECREF(entry);
    return status;
}

/* Calls port.deliver(frame, now_ns, own). */
static int hand_over(PyObject *port, PyObject *frame, PyObject *now, PyObject *own)
{
    PyObject *args[] = {port, frame, now, own};
    PyObject *result = PyObject_VectorcallMethod(text_deliver, args, 4, NULL);
    Py_XDECREF(result);
    return result ? 0 : -1;
}

/* Gives a data frame to the subscribers of a port, as `Subscribers.give` does. */
static int give(PyObject *direct, PyObject *frame, PyObject *timestamp_s)
{
    PyObject *can_id = PyTuple_GET_ITEM(frame, 0), *data = PyTuple_GET_ITEM(frame, 1);
    PyObject *by_id = PyObject_GetAttr(direct, text_by_id);
    PyObject *subscribers = by_id ? PyDict_GetItemWithError(by_id, can_id) : NULL;
    int status = by_id && !PyErr_Occurred() ? 0 : -1;
    Py_XINCREF(subscribers);
    if (status == 0 && subscribers && !PyList_Check(subscribers)) {
        PyErr_SetString(PyExc_TypeError, "the subscribers of an identifier are a list");
        status = -1;
    }
    if (status == 0 && subscribers && PyList_GET_SIZE(subscribers)) {
        PyObject *copy =
            PyByteArray_FromStringAndSize(PyBytes_AS_STRING(data), PyBytes_GET_SIZE(data));
        status = copy ? 0 : -1;
        for (Py_ssize_t i = 0; status == 0 && i < PyList_GET_SIZE(subscribers); i++) {
            PyObject *subscriber = Py_NewRef(PyList_GET_ITEM(subscribers, i));
            PyObject *args[] = {can_id, copy, timestamp_s};
            PyObject *result = PyObject_Vectorcall(subscriber, args, 3, NULL);
            status = result ? 0 : -1;
            Py_XDECREF(result);
            Py_DECREF(subscriber);
        }
        Py_XDECREF(copy);
    }
    Py_XDECREF(subscribers);
    Py_XDECREF(by_id);
    if (status == 0) {
        PyObject *heard = PyObject_GetAttr(direct, text_heard);
        status = heard ? PyDict_SetItem(heard, can_id, Py_None) : -1;
        Py_XDECREF(heard);
    }
    return status;
}

static int deliver(Line *self, PyObject *sender, PyObject *frame)
{
    int is_standard_data =
        PyTuple_GET_ITEM(frame, 2) == Py_False && PyTuple_GET_ITEM(frame, 3) == Py_False;
    long long now_ns = now_of(self);
    PyObject *now = PyLong_FromLongLong(now_ns);
    PyObject *timestamp_s = PyFloat_FromDouble((double)now_ns / 1e9);
    PyObject *live = Py_NewRef(self->live); /* a subscriber may change who takes part */
    int status = now && timestamp_s ? 0 : -1;
    for (Py_ssize_t i = 0; status == 0 && i < PyTuple_GET_SIZE(live); i++) {
        PyObject *port = PyTuple_GET_ITEM(live, i);
        if (port == sender) {
            PyObject *own = PyObject_GetAttr(port, text_receive_own_messages);
            int is_wanted = own ? PyObject_IsTrue(own) : -1;
            Py_XDECREF(own);
            status = is_wanted > 0 ? hand_over(port, frame, now, Py_True) : is_wanted;
            continue;
        }
        PyObject *direct = PyObject_GetAttr(port, text_direct);
        if (!direct)
            status = -1;
        else if (direct == Py_None || !is_standard_data)
            status = hand_over(port, frame, now, Py_False);
        else
            status = give(direct, frame, timestamp_s);
        Py_XDECREF(direct);
    }
    Py_DECREF(live);
    Py_XDECREF(now);
    Py_XDECREF(timestamp_s);
    return status;
}

static int go_on(Line *self)
{
    for (Py_ssize_t i = 0; i < self->queue_count; i++) {
        Py_ssize_t size = PyObject_Size(self->queues[i].pending);
        if (size < 0)
            return -1;
        if (size)
            return plan_arbitration(self, self->free_ns);
    }
    self->is_idle = 1;
    return 0;
}

static int is_current(PyObject *current)
{
    if (current && PyTuple_Check(current) && PyTuple_GET_SIZE(current) == 5) {
        PyObject *request = PyTuple_GET_ITEM(current, 1);
        if (PyTuple_Check(request) && PyTuple_GET_SIZE(request) == 5
            && PyTuple_Check(PyTuple_GET_ITEM(request, 4))
            && PyTuple_GET_SIZE(PyTuple_GET_ITEM(request, 4)) == 5)
            return 1;
    }
    PyErr_SetString(PyExc_AssertionError, "no frame is on the line");
    return 0;
}

static PyObject *line_end_of_frame(Line *self, PyObject *Py_UNUSED(none))
{
    PyObject *current = self->current;
    if (!is_current(current))
        return NULL;
    if (!self->is_undisturbed || PyTuple_GET_ITEM(current, 4) != Py_None)
        return ask_segment(self, "end_of_frame");
    long long start_ns = PyLong_AsLongLong(PyTuple_GET_ITEM(current, 2)), span_ns;
    long bits = PyLong_AsLong(PyTuple_GET_ITEM(current, 3));
    if (PyErr_Occurred() || duration_of(self, bits + IFS_BITS, &span_ns) < 0)
        return NULL;
    Py_INCREF(current);
    PyObject *frame = PyTuple_GET_ITEM(PyTuple_GET_ITEM(current, 1), 4);
    int status = book(self, current, start_ns + span_ns);
    if (status == 0)
        status = deliver(self, PyTuple_GET_ITEM(current, 0), frame);
    if (status == 0)
        status = go_on(self);
    Py_DECREF(current);
    if (status < 0)
        return NULL;
    Py_RETURN_NONE;
}

static PyObject *line_book(Line *self, PyObject *const *args, Py_ssize_t count)
{
    if (count != 2) {
        PyErr_SetString(PyExc_TypeError, "book() takes current and free_ns");
        return NULL;
    }
    long long free_ns = PyLong_AsLongLong(args[1]);
    if ((free_ns == -1 && PyErr_Occurred()) || !is_current(args[0]) || book(self, args[0], free_ns) < 0)
        return NULL;
    Py_RETURN_NONE;
}

static PyObject *line_deliver(Line *self, PyObject *const *args, Py_ssize_t count)
{
    Fields fields;
    if (count != 2) {
        PyErr_SetString(PyExc_TypeError, "deliver() takes sender and frame");
        return NULL;
    }
    if (read_frame(args[1], &fields) < 0 || deliver(self, args[0], args[1]) < 0)
        return NULL;
    Py_RETURN_NONE;
}

static PyObject *line_go_on(Line *self, PyObject *Py_UNUSED(none))
{
    if (go_on(self) < 0)
        return NULL;
    Py_RETURN_NONE;
}

static void forget_queues(Line *self)
{
    for (Py_ssize_t i = 0; i < self->queue_count; i++) {
        Py_XDECREF(self->queues[i].pending);
        Py_XDECREF(self->queues[i].take);
    }
    PyMem_Free(self->queues);
    self->queues = NULL;
    self->queue_count = 0;
}

static PyObject *line_get_live(Line *self, void *Py_UNUSED(closure))
{
    return Py_NewRef(self->live);
}

static int line_set_live(Line *self, PyObject *live, void *Py_UNUSED(closure))
{
    if (!live || !PyTuple_Check(live)) {
        PyErr_SetString(PyExc_TypeError, "live is a tuple of ports");
        return -1;
    }
    Py_ssize_t count = PyTuple_GET_SIZE(live);
    forget_queues(self);
    self->queues = PyMem_Calloc((size_t)(count ? count : 1), sizeof *self->queues);
    if (!self->queues) {
        PyErr_NoMemory();
        return -1;
    }
    for (Py_ssize_t i = 0; i < count; i++) {
        Queue *queue = &self->queues[i];
        self->queue_count = i + 1;
        queue->pending = PyObject_GetAttr(PyTuple_GET_ITEM(live, i), text_pending);
        queue->take = PyObject_GetAttr(PyTuple_GET_ITEM(live, i), text_take);
        if (!queue->pending || !queue->take) {
            forget_queues(self);
            return -1;
        }
    }
    Py_XSETREF(self->live, Py_NewRef(live));
    return 0;
}

/* Sets `*place` to an attribute of an object, which must be of a type; NULL = of any type. */
static int take(PyObject **place, PyObject *object, const char *name, PyTypeObject *type)
{
    PyObject *found = PyObject_GetAttrString(object, name);
    if (found && type && !PyObject_TypeCheck(found, type)) {
        PyErr_Format(PyExc_TypeError, "%s is no %s", name, type->tp_name);
        Py_CLEAR(found);
    }
    Py_XSETREF(*place, found);
    return found ? 0 : -1;
}

static int take_durations(Line *self, PyObject *durations)
{
    self->duration_count = PyList_GET_SIZE(durations);
    self->duration_ns = PyMem_Malloc((size_t)self->duration_count * sizeof(long long) + 1);
    if (!self->duration_ns) {
        PyErr_NoMemory();
        return -1;
    }
    for (Py_ssize_t i = 0; i < self->duration_count; i++) {
        self->duration_ns[i] = PyLong_AsLongLong(PyList_GET_ITEM(durations, i));
        if (PyErr_Occurred())
            return -1;
    }
    return 0;
}

static int line_init(Line *self, PyObject *args, PyObject *kwargs)
{
    PyObject *segment, *durations, *block = NULL;
    if ((kwargs && PyDict_GET_SIZE(kwargs))
        || !PyArg_ParseTuple(args, "OO!:BusLine", &segment, &PyList_Type, &durations))
        return -1;
    if (self->segment) {
        PyErr_SetString(PyExc_TypeError, "a line is made once");
        return -1;
    }
    if (take(&self->name, segment, "name", &PyUnicode_Type) < 0
        || take(&self->scheduler, segment, "scheduler", scheduler_api->type) < 0
        || take(&self->sequence, segment, "sequence", NULL) < 0
        || take(&self->passed, segment, "passed", &PyList_Type) < 0
        || take(&self->observers, segment, "observers", &PyList_Type) < 0
        || take(&self->journal, segment, "journal", NULL) < 0
        || take(&self->entries, self->journal, "entries", &PyList_Type) < 0
        || take(&block, self->journal, "block_frames", &PyLong_Type) < 0)
        return -1;
    self->block_frames = PyLong_AsSsize_t(block);
    Py_DECREF(block);
    if (PyErr_Occurred() || take_durations(self, durations) < 0)
        return -1;
    self->segment = Py_NewRef(segment);
    self->current = Py_NewRef(Py_None);
    self->end = Py_NewRef(Py_None);
    self->is_idle = 1;
    self->live = PyTuple_New(0);
    if (!self->live || take(&self->arbitrate, (PyObject *)self, "arbitrate", NULL) < 0
        || take(&self->end_of_frame, (PyObject *)self, "end_of_frame", NULL) < 0)
        return -1;
    return 0;
}

static int line_traverse(Line *self, visitproc visit, void *arg)
{
    Py_VISIT(self->scheduler);
    Py_VISIT(self->segment);
    Py_VISIT(self->journal);
    Py_VISIT(self->entries);
    Py_VISIT(self->passed);
    Py_VISIT(self->sequence);
    Py_VISIT(self->arbitrate);
    Py_VISIT(self->end_of_frame);
    Py_VISIT(self->live);
    Py_VISIT(self->observers);
    Py_VISIT(self->current);
    Py_VISIT(self->end);
    for (Py_ssize_t i = 0; i < self->queue_count; i++) {
        Py_VISIT(self->queues[i].pending);
        Py_VISIT(self->queues[i].take);
    }
    return 0;
}

static int line_clear(Line *self)
{
    Py_CLEAR(self->name);
    Py_CLEAR(self->scheduler);
    Py_CLEAR(self->segment);
    Py_CLEAR(self->journal);
    Py_CLEAR(self->entries);
    Py_CLEAR(self->passed);
    Py_CLEAR(self->sequence);
    Py_CLEAR(self->arbitrate);
    Py_CLEAR(self->end_of_frame);
    Py_CLEAR(self->live);
    Py_CLEAR(self->observers);
    Py_CLEAR(self->current);
    Py_CLEAR(self->end);
    forget_queues(self);
    return 0;
}

static void line_dealloc(Line *self)
{
    PyObject_GC_UnTrack(self);
    line_clear(self);
    PyMem_Free(self->duration_ns);
    Py_TYPE(self)->tp_free((PyObject *)self);
}

static PyMemberDef line_members[] = {
    {"current", T_OBJECT, offsetof(Line, current), 0, "The frame on the line, or None."},
    {"end", T_OBJECT, offsetof(Line, end), 0, "The event of its end."},
    {"free_ns", T_LONGLONG, offsetof(Line, free_ns), 0, "End of the last intermission."},
    {"is_idle", T_BOOL, offsetof(Line, is_idle), 0, "Whether nothing is on the line or planned."},
    {"is_undisturbed", T_BOOL, offsetof(Line, is_undisturbed), 0,
     "Whether nothing disturbs the line."},
    {NULL},
};

static PyGetSetDef line_getset[] = {
    {"live", (getter)line_get_live, (setter)line_set_live, "The ports that take part.", NULL},
    {NULL},
};

static PyMethodDef line_methods[] = {
    {"wake", (PyCFunction)line_wake, METH_NOARGS, "Take note of a new request."},
    {"request_data", (PyCFunction)(void (*)(void))line_request_data, METH_FASTCALL,
     "Put a data frame into a transmit queue and take note of it."},
    {"arbitrate", (PyCFunction)line_arbitrate, METH_NOARGS, "Start the next frame, or rest."},
    {"end_of_frame", (PyCFunction)line_end_of_frame, METH_NOARGS, "End the frame on the line."},
    {"book", (PyCFunction)(void (*)(void))line_book, METH_FASTCALL,
     "Give a frame that has ended to load and records."},
    {"deliver", (PyCFunction)(void (*)(void))line_deliver, METH_FASTCALL,
     "Give a frame to every port but its sender."},
    {"go_on", (PyCFunction)line_go_on, METH_NOARGS, "Arbitrate when the line is free."},
    {NULL},
};

static PyTypeObject LineType = {
    PyVarObject_HEAD_INIT(NULL, 0).tp_name = "axisrig.bench.bus.can._line.BusLine",
    .tp_basicsize = sizeof(Line),
    .tp_flags = Py_TPFLAGS_DEFAULT | Py_TPFLAGS_HAVE_GC,
    .tp_doc = "The line of one segment.",
    .tp_new = PyType_GenericNew,
    .tp_init = (initproc)line_init,
    .tp_traverse = (traverseproc)line_traverse,
    .tp_clear = (inquiry)line_clear,
    .tp_dealloc = (destructor)line_dealloc,
    .tp_members = line_members,
    .tp_getset = line_getset,
    .tp_methods = line_methods,
};

/* --- module ---------------------------------------------------------------------------------- */

static PyMethodDef functions[] = {
    {"frame_bits", frame_bits, METH_O, "Exact length of a frame, with the intermission."},
    {NULL},
};

static PyModuleDef module = {
    PyModuleDef_HEAD_INIT,
    .m_name = "axisrig.bench.bus.can._line",
    .m_doc = "The line of a segment in C.",
    .m_size = -1,
    .m_methods = functions,
};

/* Returns the number of a phase, -1 with an exception. */
static long phase(PyObject *clock, const char *name)
{
    PyObject *phases = PyObject_GetAttrString(clock, "Phase");
    PyObject *one = phases ? PyObject_GetAttrString(phases, name) : NULL;
    long number = one ? PyLong_AsLong(one) : -1;
    Py_XDECREF(phases);
    Py_XDECREF(one);
    return number;
}

static int find_partners(void)
{
    PyObject *clock = PyImport_ImportModule("axisrig.kernel.time.clock");
    PyObject *frame = PyImport_ImportModule("axisrig.bench.bus.can.frame");
    PyObject *type = frame ? PyObject_GetAttrString(frame, "Frame") : NULL;
    if (clock) {
        ARBITRATION = phase(clock, "ARBITRATION");
        DELIVERY = phase(clock, "DELIVERY");
    }
    frame_type = (PyTypeObject *)type;
    PyObject *scheduler = PyImport_ImportModule("axisrig.kernel.time._scheduler");
    scheduler_api = scheduler ? PyCapsule_Import(AXISRIG_SCHEDULER_API, 0) : NULL;
    Py_XDECREF(scheduler);
    Py_XDECREF(clock);
    Py_XDECREF(frame);
    text_drain = PyUnicode_InternFromString("drain");
    text_pending = PyUnicode_InternFromString("pending");
    text_take = PyUnicode_InternFromString("take");
    text_direct = PyUnicode_InternFromString("direct");
    text_by_id = PyUnicode_InternFromString("by_id");
    text_heard = PyUnicode_InternFromString("heard");
    text_receive_own_messages = PyUnicode_InternFromString("receive_own_messages");
    text_deliver = PyUnicode_InternFromString("deliver");
    return PyErr_Occurred() ? -1 : 0;
}

PyMODINIT_FUNC PyInit__line(void)
{
    fill_tables();
    if (find_partners() < 0 || PyType_Ready(&LineType) < 0)
        return NULL;
    PyObject *made = PyModule_Create(&module);
    if (made && PyModule_AddObjectRef(made, "BusLine", (PyObject *)&LineType) < 0)
        Py_CLEAR(made);
    return made;
}
