/* A feed table as another tool would export it: a position loop and a spindle, in mm and revolutions.

   behaviour 4: after 0.2 s it crashes. 3: it warns, with its text. behaviour 1 and 2: after 0.2 s the position is no number, or infinite.
   s' = gain (s_set - s); the motor turns once per 10 mm. Exact for an s_set that is constant in a
   step. */

#include "api.h"

enum { S_SET, S, PHI, SPEED, GAIN, S_START };
static const double PI = 3.14159265358979323846, LEAD = 10.0;

static void outputs(Instance *table) {
    const double speed = table->real[GAIN] * (table->real[S_SET] - table->real[S]);
    table->real[PHI] = table->real[S] / LEAD * 2 * PI;
    table->real[SPEED] = speed / LEAD * 60;
}
static void defaults(Instance *table) { table->real[GAIN] = 40.0; }

static void start(Instance *table) {
    table->real[S] = table->real[S_START];
    outputs(table);
}

static bool level(const Instance *table) { return table->real[S] > 0; }

static int step(Instance *table, double begin, double size, bool *early) {
    double *r = table->real;
    (void)early;
    r[S] = r[S_SET] + (r[S] - r[S_SET]) * exp(-r[GAIN] * size);
    table->last = table->time = begin + size;
    if (table->behaviour == 3 && begin == 0) {
        say(table, WARNING, table->text);
        return WARNING;
    }
    if (table->behaviour == 4 && table->time > 0.2) abort();
    if (table->behaviour && table->behaviour < 3 && table->time > 0.2) r[S] = table->behaviour == 1 ? NAN : INFINITY;
    outputs(table);
    return OK;
}
