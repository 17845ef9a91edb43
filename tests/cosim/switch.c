/* A switch as another tool would export it: it closes when the tip is as deep as `trip`.

   volts is 24 then, else 0. depth and trip are in mm, which the description does not say. */

#include "api.h"

enum { DEPTH, VOLTS, TRIP };

static bool level(const Instance *at) { return at->real[DEPTH] >= at->real[TRIP]; }

static void defaults(Instance *at) { at->real[TRIP] = -100.0; }

static void start(Instance *at) { at->real[VOLTS] = level(at) ? 24.0 : 0.0; }

static int step(Instance *at, double begin, double size, bool *early) {
    (void)early;
    at->last = at->time = begin + size;
    start(at);
    return OK;
}
