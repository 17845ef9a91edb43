/* A light gate as another tool would export it: dark while the rod stands in its beam.

   It follows the trajectory of a step, a cubic between its ends (m, s); dark is
   trip - beam < z <= trip. Where it is allowed to (FMI 3) it returns at the instant at which
   the light changes. The light must last for 1 us to be seen inside a step. With a behaviour it
   stands still from 10 ms on, says ok, and that its time is what it was (1) or no number (2). */

#include "api.h"

enum { STEP_TIME, STEP_SIZE, Z, RATE, Z_END, RATE_END, TRIP, BEAM };

static const double LOOK = 1e-6;

static void defaults(Instance *gate) { gate->real[STEP_SIZE] = gate->real[BEAM] = 1.0; }

static void start(Instance *gate) { (void)gate; }

static bool dark(const Instance *gate, double time) {
    const double *r = gate->real, h = r[STEP_SIZE], u = (time - r[STEP_TIME]) / h;
    const double bend = 2 * (r[Z] - r[Z_END]) + h * (r[RATE] + r[RATE_END]);
    const double bow = 3 * (r[Z_END] - r[Z]) - h * (2 * r[RATE] + r[RATE_END]);
    const double z = r[Z] + u * (h * r[RATE] + u * (bow + u * bend));
    return r[TRIP] - r[BEAM] < z && z <= r[TRIP];
}

static bool level(const Instance *gate) { return dark(gate, gate->time); }

/* The first instant in (begin, end] at which the light is other than at begin; else end. */
static double change(const Instance *gate, double begin, double end) {
    const bool before = dark(gate, begin);
    double low = begin, high = begin;
    while (dark(gate, high) == before) {
        if (high >= end) return end;
        low = high;
        high = fmin(high + LOOK, end);
    }
    for (double middle; middle = low + (high - low) / 2, low < middle && middle < high;)
        *(dark(gate, middle) == before ? &low : &high) = middle;
    return high;
}

static int step(Instance *gate, double begin, double size, bool *early) {
    const double end = begin + size;
    if (gate->behaviour && begin > 10e-3) {
        gate->last = gate->behaviour == 2 ? NAN : gate->time;
        return OK;
    }
    gate->time = gate->early_allowed ? change(gate, begin, end) : end;
    *early = gate->time < end;
    gate->last = gate->time;
    return OK;
}
