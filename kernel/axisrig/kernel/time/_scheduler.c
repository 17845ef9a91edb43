/* `axisrig.kernel.time.scheduler.Scheduler` in C, for the compiled build.

   Same members, same order of events (time, phase, call order), same messages of errors: the tests
   drive both with the same random calls. An event is an object of its own, not a list; nobody
   outside looks into it. */

#define PY_SSIZE_T_CLEAN
#include "_scheduler.h"
#include <structmember.h>

typedef struct {
    PyObject_HEAD
    long long time_ns;
    long phase;
    unsigned long long sequence;
    PyObject *action; /* NULL once it has run or is cancelled */
} Event;

typedef struct {
    PyObject_HEAD
    long long now_ns;
    unsigned long long sequence;
    Event **heap; /* heap[0] is the next one */
    Py_ssize_t count, capacity;
    char is_advancing;
} Scheduler;

/* --- events ---------------------------------------------------------------------------------- */

static int event_traverse(Event *self, visitproc visit, void *arg)
{
    Py_VISIT(self->action);
    return 0;
}

static int event_clear(Event *self)
{
    Py_CLEAR(self->action);
    return 0;
}

static void event_dealloc(Event *self)
{
    PyObject_GC_UnTrack(self);
    Py_CLEAR(self->action);
    PyObject_GC_Del(self);
}

static PyTypeObject EventType = {
    PyVarObject_HEAD_INIT(NULL, 0).tp_name = "axisrig.kernel.time._scheduler.Event",
    .tp_basicsize = sizeof(Event),
    .tp_flags = Py_TPFLAGS_DEFAULT | Py_TPFLAGS_HAVE_GC,
    .tp_doc = "Handle of `call_at`.",
    .tp_traverse = (traverseproc)event_traverse,
    .tp_clear = (inquiry)event_clear,
    .tp_dealloc = (destructor)event_dealloc,
};

static int is_before(const Event *a, const Event *b)
{
    if (a->time_ns != b->time_ns)
        return a->time_ns < b->time_ns;
    if (a->phase != b->phase)
        return a->phase < b->phase;
    return a->sequence < b->sequence;
}

/* Puts an event into the heap, which takes over the reference. */
static int push(Scheduler *self, Event *event)
{
    if (self->count == self->capacity) {
        Py_ssize_t capacity = self->capacity ? 2 * self->capacity : 64;
        Event **heap = PyMem_Realloc(self->heap, (size_t)capacity * sizeof *heap);
        if (!heap) {
            PyErr_NoMemory();
            return -1;
        }
        self->heap = heap;
        self->capacity = capacity;
    }
    Py_ssize_t place = self->count++;
    while (place > 0) {
        Py_ssize_t above = (place - 1) / 2;
        if (!is_before(event, self->heap[above]))
            break;
        self->heap[place] = self->heap[above];
        place = above;
    }
    self->heap[place] = event;
    return 0;
}

/* Takes the next event out of the heap, with its reference; there must be one. */
static Event *pop(Scheduler *self)
{
    Event *first = self->heap[0], *last = self->heap[--self->count];
    Py_ssize_t place = 0, count = self->count;
    while (2 * place + 1 < count) {
        Py_ssize_t below = 2 * place + 1;
        if (below + 1 < count && is_before(self->heap[below + 1], self->heap[below]))
            below++;
        if (!is_before(self->heap[below], last))
            break;
        self->heap[place] = self->heap[below];
        place = below;
    }
    if (count)
        self->heap[place] = last;
    return first;
}

/* --- the scheduler --------------------------------------------------------------------------- */

static PyObject *plan(Scheduler *self, long long time_ns, long phase, PyObject *action)
{
    if (time_ns < self->now_ns) {
        PyErr_Format(PyExc_ValueError, "call_at(%lld ns) is before now (%lld ns)", time_ns,
                     self->now_ns);
        return NULL;
    }
    Event *event = PyObject_GC_New(Event, &EventType);
    if (!event)
        return NULL;
    event->time_ns = time_ns;
    event->phase = phase;
    event->sequence = self->sequence++;
    event->action = Py_NewRef(action);
    PyObject_GC_Track(event);
    if (push(self, event) < 0) {
        Py_DECREF(event);
        return NULL;
    }
    return Py_NewRef(event);
}

static PyObject *scheduler_call_at(Scheduler *self, PyObject *const *args, Py_ssize_t count)
{
    if (count != 3) {
        PyErr_SetString(PyExc_TypeError, "call_at() takes time_ns, phase and action");
        return NULL;
    }
    long long time_ns = PyLong_AsLongLong(args[0]);
    if (time_ns == -1 && PyErr_Occurred())
        return NULL;
    long phase = PyLong_AsLong(args[1]);
    if (phase == -1 && PyErr_Occurred())
        return NULL;
    return plan(self, time_ns, phase, args[2]);
}

static PyObject *scheduler_cancel(Scheduler *Py_UNUSED(self), PyObject *event)
{
    if (!Py_IS_TYPE(event, &EventType)) {
        PyErr_SetString(PyExc_TypeError, "cancel() takes what call_at() returned");
        return NULL;
    }
    Py_CLEAR(((Event *)event)->action);
    Py_RETURN_NONE;
}

static int begin(Scheduler *self)
{
    if (self->is_advancing) {
        PyErr_SetString(PyExc_RuntimeError,
                        "simulated time is already advancing: an event action must not wait; "
                        "send the request and go on in a later event");
        return -1;
    }
    self->is_advancing = 1;
    return 0;
}

/* Runs the next event; -1 with an exception of its action. */
static int run_next(Scheduler *self)
{
    Event *event = pop(self);
    PyObject *action = event->action;
    event->action = NULL;
    int status = 0;
    if (action) {
        self->now_ns = event->time_ns;
        PyObject *result = PyObject_CallNoArgs(action);
        status = result ? 0 : -1;
        Py_XDECREF(result);
        Py_DECREF(action);
    }
    Py_DECREF(event);
    return status;
}

static PyObject *scheduler_run_until(Scheduler *self, PyObject *end)
{
    long long end_ns = PyLong_AsLongLong(end);
    if (end_ns == -1 && PyErr_Occurred())
        return NULL;
    if (end_ns < self->now_ns) {
        PyErr_Format(PyExc_ValueError, "run_until(%lld ns) is before now (%lld ns)", end_ns,
                     self->now_ns);
        return NULL;
    }
    if (begin(self) < 0)
        return NULL;
    while (self->count && self->heap[0]->time_ns <= end_ns)
        if (run_next(self) < 0) {
            self->is_advancing = 0;
            return NULL;
        }
    self->now_ns = end_ns;
    self->is_advancing = 0;
    Py_RETURN_NONE;
}

static PyObject *scheduler_run_while(Scheduler *self, PyObject *const *args, Py_ssize_t count)
{
    if (count != 2) {
        PyErr_SetString(PyExc_TypeError, "run_while() takes condition and timeout_ns");
        return NULL;
    }
    int is_limited = args[1] != Py_None;
    long long end_ns = 0;
    if (is_limited) {
        end_ns = PyLong_AsLongLong(args[1]);
        if (end_ns == -1 && PyErr_Occurred())
            return NULL;
        end_ns += self->now_ns;
    }
    if (begin(self) < 0)
        return NULL;
    for (;;) {
        PyObject *holds = PyObject_CallNoArgs(args[0]);
        int goes_on = holds ? PyObject_IsTrue(holds) : -1;
        Py_XDECREF(holds);
        if (goes_on < 0)
            break;
        if (!goes_on) {
            self->is_advancing = 0;
            Py_RETURN_TRUE;
        }
        if (!is_limited && !self->count) {
            PyErr_SetString(PyExc_RuntimeError, "waiting without limit and no event is pending");
            break;
        }
        if (is_limited && (!self->count || self->heap[0]->time_ns > end_ns)) {
            self->now_ns = end_ns;
            self->is_advancing = 0;
            Py_RETURN_FALSE;
        }
        if (run_next(self) < 0)
            break;
    }
    self->is_advancing = 0;
    return NULL;
}

static int scheduler_traverse(Scheduler *self, visitproc visit, void *arg)
{
    for (Py_ssize_t i = 0; i < self->count; i++)
        Py_VISIT(self->heap[i]);
    return 0;
}

static int scheduler_clear(Scheduler *self)
{
    while (self->count)
        Py_DECREF(self->heap[--self->count]);
    return 0;
}

static void scheduler_dealloc(Scheduler *self)
{
    PyObject_GC_UnTrack(self);
    scheduler_clear(self);
    PyMem_Free(self->heap);
    Py_TYPE(self)->tp_free((PyObject *)self);
}

static PyMemberDef scheduler_members[] = {
    {"now_ns", T_LONGLONG, offsetof(Scheduler, now_ns), READONLY, "Current simulated time."},
    {"running", T_BOOL, offsetof(Scheduler, is_advancing), READONLY,
     "Whether an action is being run, that is whether waiting is refused."},
    {NULL},
};

static PyMethodDef scheduler_methods[] = {
    {"call_at", (PyCFunction)(void (*)(void))scheduler_call_at, METH_FASTCALL,
     "Run an action at a time in a phase; return the handle that `cancel` takes."},
    {"cancel", (PyCFunction)scheduler_cancel, METH_O, "Forget an event."},
    {"run_until", (PyCFunction)scheduler_run_until, METH_O,
     "Run every event up to and including a time."},
    {"run_while", (PyCFunction)(void (*)(void))scheduler_run_while, METH_FASTCALL,
     "Advance event by event while a condition holds."},
    {NULL},
};

static PyTypeObject SchedulerType = {
    PyVarObject_HEAD_INIT(NULL, 0).tp_name = "axisrig.kernel.time._scheduler.Scheduler",
    .tp_basicsize = sizeof(Scheduler),
    .tp_flags = Py_TPFLAGS_DEFAULT | Py_TPFLAGS_HAVE_GC,
    .tp_doc = "The simulated clock; starts at 0 ns.",
    .tp_new = PyType_GenericNew,
    .tp_traverse = (traverseproc)scheduler_traverse,
    .tp_clear = (inquiry)scheduler_clear,
    .tp_dealloc = (destructor)scheduler_dealloc,
    .tp_members = scheduler_members,
    .tp_methods = scheduler_methods,
};

/* --- module ---------------------------------------------------------------------------------- */

static PyObject *api_call_at(PyObject *self, long long time_ns, long phase, PyObject *action)
{
    return plan((Scheduler *)self, time_ns, phase, action);
}

static long long api_now_ns(PyObject *self)
{
    return ((Scheduler *)self)->now_ns;
}

static AxisrigScheduler api = {&SchedulerType, api_call_at, api_now_ns};

static PyModuleDef module = {
    PyModuleDef_HEAD_INIT,
    .m_name = "axisrig.kernel.time._scheduler",
    .m_doc = "The simulated clock in C.",
    .m_size = -1,
};

PyMODINIT_FUNC PyInit__scheduler(void)
{
    if (PyType_Ready(&EventType) < 0 || PyType_Ready(&SchedulerType) < 0)
        return NULL;
    PyObject *made = PyModule_Create(&module);
    if (!made)
        return NULL;
    PyObject *capsule = PyCapsule_New(&api, AXISRIG_SCHEDULER_API, NULL);
    if (PyModule_AddObjectRef(made, "Scheduler", (PyObject *)&SchedulerType) < 0
        || PyModule_AddObjectRef(made, "API", capsule) < 0) {
        Py_XDECREF(capsule);
        Py_DECREF(made);
        return NULL;
    }
    Py_DECREF(capsule);
    return made;
}
