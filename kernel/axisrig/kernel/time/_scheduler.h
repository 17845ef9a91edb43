/* What other extensions may use of the scheduler in C, by the capsule
   `axisrig.kernel.time._scheduler.API`. */

#ifndef AXISRIG_SCHEDULER_H
#define AXISRIG_SCHEDULER_H

#include <Python.h>

#define AXISRIG_SCHEDULER_API "axisrig.kernel.time._scheduler.API"

typedef struct {
    PyTypeObject *type;
    /* As `Scheduler.call_at`, for an instance of `type`; a new reference, NULL with an exception. */
    PyObject *(*call_at)(PyObject *scheduler, long long time_ns, long phase, PyObject *action);
    long long (*now_ns)(PyObject *scheduler);
} AxisrigScheduler;

#endif
