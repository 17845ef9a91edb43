/* A co-simulation FMU that misbehaves as its parameter `behaviour` says; -DFMI=2 or -DFMI=3.

   x (mm) is the integral of u (mm/s), level is x > limit; both exact, for u is constant in a step. */

#include "api.h"

enum { X, U, LIMIT, SCALE };
enum {
    PLAIN,
    DISCARDS_LONG_STEPS,   /* above 0.3 ms: nothing is done */
    DISCARDS_HALF_WAY,     /* above 0.3 ms: half of it is done */
    DISCARDS_ALL,
    TELLS_NO_PROGRESS,     /* discards and does not say how far it came */
    ENDS,                  /* asks for the end at 5 ms */
    FAILS,                 /* error at 5 ms */
    WARNS,
    RETURNS_EARLY,         /* FMI 3: at the instant at which the level changes */
    RETURNS_AT_ONCE,       /* FMI 3: again and again without progress */
    CRASHES,
    NOT_A_NUMBER,
    STANDS_STILL,          /* from 5 ms on: ok, and nothing is done */
    LOSES_ITS_TIME,        /* from 5 ms on: ok, and its time is no number */
    WAITS,                 /* goes on in whole milliseconds only */
    ENDS_WITHOUT_A_TIME,   /* asks for the end at 5 ms and does not say how far it came */
    HESITATES,             /* FMI 3: returns early `scale` times without progress, then goes on */
    CREEPS                 /* a microsecond a step: early return or discard */
};

static void defaults(Instance *odd) { odd->real[LIMIT] = odd->real[SCALE] = 1.0; }

static void start(Instance *odd) { (void)odd; }

static bool level(const Instance *odd) { return odd->real[X] > odd->real[LIMIT]; }

static void move(Instance *odd, double step) {
    odd->real[X] += odd->real[U] * step;
    odd->time += step;
    odd->last = odd->time;
}

static int step(Instance *odd, double begin, double size, bool *early) {
    const bool is_long = size > 0.3e-3 * (1 + 1e-9);
    if (fabs(begin - odd->time) > 1e-9) {
        say(odd, ERROR, "asked for another time than mine");
        return ERROR;
    }
    odd->last = odd->time;
    switch (odd->behaviour) {
    case DISCARDS_LONG_STEPS:
        if (is_long) return DISCARD;
        break;
    case DISCARDS_HALF_WAY:
        if (is_long) {
            move(odd, size / 2);
            return DISCARD;
        }
        break;
    case DISCARDS_ALL:
        return DISCARD;
    case TELLS_NO_PROGRESS:
        odd->last = NAN;
        return DISCARD;
    case ENDS:
    case ENDS_WITHOUT_A_TIME:
        if (odd->time + size > 5e-3) {
            odd->ended = true;
            if (odd->behaviour == ENDS_WITHOUT_A_TIME) odd->last = NAN;
            return FMI == 2 ? DISCARD : OK;
        }
        break;
    case FAILS:
        if (odd->time + size > 5e-3) {
            say(odd, ERROR, "the spring is broken");
            return ERROR;
        }
        break;
    case WARNS:
        say(odd, WARNING, "hot");
        move(odd, size);
        return WARNING;
    case RETURNS_EARLY: {
        const double to_go = (odd->real[LIMIT] - odd->real[X]) / odd->real[U];
        if (odd->early_allowed && to_go > 1e-9 && to_go < size) {
            move(odd, to_go);
            odd->real[X] = nextafter(odd->real[LIMIT], INFINITY);
            *early = true;
            return OK;
        }
        break;
    }
    case RETURNS_AT_ONCE:
        *early = true;
        return OK;
    case CRASHES:
        abort();
    case STANDS_STILL:
        if (begin > 5e-3 - 1e-9) return OK;
        break;
    case LOSES_ITS_TIME:
        move(odd, size);
        if (begin > 5e-3 - 1e-9) odd->last = NAN;
        return OK;
    case WAITS: {
        const double end = floor((begin + size) * 1e3 + 1e-6) * 1e-3;
        if (end > odd->own + 1e-9) {
            odd->real[X] += odd->real[U] * (end - odd->own);
            odd->own = end;
        }
        odd->time = begin + size;
        odd->last = odd->own;
        return OK;
    }
    case HESITATES:
        if (odd->own < odd->real[SCALE]) {
            odd->own += 1;
            *early = true;
            return OK;
        }
        odd->own = 0;
        break;
    case CREEPS:
        if (size > 1e-6 * (1 + 1e-9)) {
            move(odd, 1e-6);
            *early = true;
            return FMI == 2 ? DISCARD : OK;
        }
        break;
    case NOT_A_NUMBER:
        move(odd, size);
        odd->real[X] = NAN;
        return OK;
    }
    move(odd, size);
    return OK;
}
