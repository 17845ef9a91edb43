/* An ideal axis: it is where the ramp of its demand is (m, m/s, s). */

#include "api.h"

enum { X_REF, V_REF, T_REF, T_END, X, V, X_START };

static void defaults(Instance *rod) { (void)rod; }

static void start(Instance *rod) {
    rod->real[X] = rod->real[X_REF] = rod->real[X_START];
}

static bool level(const Instance *rod) { return rod->real[V] > 0; }

static int step(Instance *rod, double begin, double size, bool *early) {
    double *r = rod->real;
    (void)early;
    rod->last = rod->time = begin + size;
    r[X] = r[X_REF] + r[V_REF] * (fmin(rod->time, r[T_END]) - r[T_REF]);
    r[V] = begin < r[T_END] ? r[V_REF] : 0.0; /* with which it came here */
    return OK;
}
