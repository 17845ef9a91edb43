/* Integration with a fixed step, events located inside it.
 *
 * Between events every relation rests at its remembered value, so that the right-hand side is
 * smooth. After each internal step the functions of the relations are looked at: one that
 * contradicts its memory lies past an event. The earliest such instant is enclosed to
 * TIME_TOLERANCE, the state is taken just past it, and the discrete equations are iterated until
 * nothing changes.
 */
#include <float.h>
#include <string.h>

#define TIME_TOLERANCE 1e-11 /* s */
#define MAX_SEARCH 200       /* evaluations to enclose one event */
#define MAX_ITERATIONS 100   /* of the discrete equations at one instant */
#define MAX_EVENTS 10000     /* in one communication step */

/* Everything that an instance remembers between two calls. */
typedef struct {
    double t;
    double y[N_Y + 1];
    double p[N_P + 1];
    double ticks[N_CLOCKS + 1]; /* instants of each clock that have passed */
} Core;

/* What went wrong. place: file:line or "". index: of the variable, or -1. */
typedef enum {
    SOLVER_OK,
    SOLVER_TERMINATED, /* the model called terminate(); text: its message */
    SOLVER_NOT_FINITE,
    SOLVER_NO_FIXED_POINT,
    SOLVER_TOO_MANY_EVENTS,
    SOLVER_ASSERTION,
    SOLVER_NO_INTERVAL,
} SolverResult;

typedef struct {
    SolverResult result;
    double t;
    int state;        /* of SOLVER_NOT_FINITE: index in y */
    const char *text; /* of SOLVER_ASSERTION: the message, else the place in the source */
} SolverReport;

static SolverReport report(SolverResult result, double t, int state, const char *text)
{
    const SolverReport r = {result, t, state, text};
    return r;
}

/* What the memory of relation k becomes when its function is z. */
static double relation_value(int k, double z, double memory)
{
    switch (RELATIONS[k].kind) {
    case WHOLE_BELOW:
        return floor(z);
    case WHOLE_ABOVE:
        return ceil(z);
    case WHOLE_INSIDE:
        return trunc(z);
    case ZERO_IS_FALSE:
        return z < 0.0 ? 1.0 : 0.0;
    case ZERO_IS_TRUE:
        return z <= 0.0 ? 1.0 : 0.0;
    case ZERO_KEEPS:
        break;
    }
    return z == 0.0 ? memory : z < 0.0 ? 1.0 : 0.0;
}

static bool contradicts(int k, double z, const double *p)
{
    const double memory = p[RELATIONS[k].memory];
    return relation_value(k, z, memory) != memory;
}

/* The value that the function of relation k passes on its way from its memory to z. */
static double boundary(int k, double z, double memory)
{
    switch (RELATIONS[k].kind) {
    case WHOLE_BELOW:
        return z < memory ? memory : memory + 1.0;
    case WHOLE_ABOVE:
        return z > memory ? memory : memory - 1.0;
    case WHOLE_INSIDE:
        return z > memory ? memory + (memory >= 0.0 ? 1.0 : 0.0)
                          : memory - (memory <= 0.0 ? 1.0 : 0.0);
    default:
        return 0.0;
    }
}

/* The first relation that contradicts its memory, or -1. */
static int first_contradiction(const double *z, const double *p)
{
    for (int k = 0; k < N_RELATIONS; k++) {
        if (contradicts(k, z[k], p)) {
            return k;
        }
    }
    return -1;
}

/* One step of the classical fourth-order Runge-Kutta method. */
static void runge_kutta(double t, const double *x, const double *p, double h, double *result)
{
    double k1[N_X + 1], k2[N_X + 1], k3[N_X + 1], k4[N_X + 1], at[N_X + 1];
    model_derivatives(t, x, p, k1);
    for (int i = 0; i < N_X; i++) {
        at[i] = x[i] + 0.5 * h * k1[i];
    }
    model_derivatives(t + 0.5 * h, at, p, k2);
    for (int i = 0; i < N_X; i++) {
        at[i] = x[i] + 0.5 * h * k2[i];
    }
    model_derivatives(t + 0.5 * h, at, p, k3);
    for (int i = 0; i < N_X; i++) {
        at[i] = x[i] + h * k3[i];
    }
    model_derivatives(t + h, at, p, k4);
    for (int i = 0; i < N_X; i++) {
        result[i] = x[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
    }
}

/* The first state that is not a finite number, or -1. */
static int not_finite(const double *y, int count)
{
    for (int i = 0; i < count; i++) {
        if (!isfinite(y[i])) {
            return i;
        }
    }
    return -1;
}

static void refresh_relations(Core *c)
{
    double z[N_RELATIONS + 1];
    model_relations(c->t, c->y, c->p, z);
    for (int k = 0; k < N_RELATIONS; k++) {
        double *memory = &c->p[RELATIONS[k].memory];
        *memory = relation_value(k, z[k], *memory);
    }
}

static void set_initial_flag(Core *c, bool value)
{
#if INITIAL_FLAG >= 0
    c->p[INITIAL_FLAG] = value ? 1.0 : 0.0;
#endif
    (void)c, (void)value;
}

/* All equations once, with what was before the event at rest. */
static void evaluate(Core *c, bool at_start)
{
    if (at_start) {
        model_initial(c->t, c->y, c->p);
    }
    model_algebraics(c->t, c->y, c->p);
    refresh_relations(c);
    model_runtime(c->t, c->y, c->p);
    if (at_start) { /* only initial() is an edge now */
        set_initial_flag(c, false);
        model_conditions(c->t, c->y, c->p);
        set_initial_flag(c, true);
    }
    model_updates(c->t, c->y, c->p, !at_start || INITIAL_FLAG >= 0);
    model_runtime(c->t, c->y, c->p);
}

/* pre(v) := v; clocks have ticked. */
static void remember(Core *c)
{
    for (int k = 0; k < N_CLOCKS; k++) {
        c->p[CLOCKS[k].flag] = 0.0;
    }
    model_conditions(c->t, c->y, c->p);
    model_previous(c->y, c->p);
}

/* Evaluate until nothing changes; false when there is no end. */
static bool agree(Core *c, bool at_start)
{
    for (int i = 0; i < MAX_ITERATIONS; i++) {
        Core before;
        memcpy(&before, c, sizeof before);
        evaluate(c, at_start);
        if (memcmp(&before, c, sizeof before) == 0) {
            return true;
        }
    }
    return false;
}

/* Bring all discrete variables into agreement at one instant: first all equations among each other,
 * then what was before the event follows, which may be a further event.
 */
static SolverReport settle(Core *c, bool at_start)
{
    set_initial_flag(c, at_start);
    bool rests = false;
    for (int i = 0; i < MAX_ITERATIONS && !rests; i++) {
        if (!agree(c, at_start && i == 0)) {
            break;
        }
        Core before;
        memcpy(&before, c, sizeof before);
        remember(c);
        set_initial_flag(c, false);
        rests = memcmp(&before, c, sizeof before) == 0;
    }
    if (!rests) {
        return report(SOLVER_NO_FIXED_POINT, c->t, -1, "");
    }
    const char *failed = model_failed_assertion(c->t, c->y, c->p);
    const int bad = not_finite(c->y, N_Y);
    if (failed != NULL) {
        return report(SOLVER_ASSERTION, c->t, -1, failed);
    }
    return bad < 0 ? report(SOLVER_OK, c->t, -1, "") : report(SOLVER_NOT_FINITE, c->t, bad, "");
}

/* Enclose the earliest contradiction inside (0, h]; z0 and z1 are the functions at both ends.
 *
 * The estimate is the secant of each contradicting function; every third one is the middle, so that
 * the enclosure shrinks in any case. Returns the far end; x1 and z1 belong to it.
 */
static double locate(const Core *c, double h, double *z0, double *z1, double *x1)
{
    const double tolerance = larger(TIME_TOLERANCE, 4.0 * DBL_EPSILON * fabs(c->t));
    double low = 0.0, high = h;
    for (int n = 0; n < MAX_SEARCH && high - low > tolerance; n++) {
        double guess = high;
        for (int k = 0; k < N_RELATIONS; k++) {
            if (contradicts(k, z1[k], c->p) && z0[k] != z1[k]) {
                const double from = z0[k] - boundary(k, z1[k], c->p[RELATIONS[k].memory]);
                guess = smaller(guess, low + (high - low) * from / (z0[k] - z1[k]));
            }
        }
        if (n % 3 == 2) {
            guess = 0.5 * (low + high);
        }
        guess = larger(low + 0.5 * tolerance, smaller(guess, high - 0.5 * tolerance));
        double x[N_X + 1], z[N_RELATIONS + 1];
        runge_kutta(c->t, c->y, c->p, guess, x);
        model_relations(c->t + guess, x, c->p, z);
        if (first_contradiction(z, c->p) < 0) {
            low = guess;
            memcpy(z0, z, sizeof z);
        } else {
            high = guess;
            memcpy(z1, z, sizeof z);
            memcpy(x1, x, sizeof x);
        }
    }
    return high;
}

/* A time that only rounding keeps from a whole nanosecond is that nanosecond. So a span gives the
 * same bits however it is cut into communication steps at whole internal steps.
 */
static double whole_ns(double t)
{
    const double ns = nearbyint(t * 1e9) * 1e-9;
    return fabs(t - ns) <= 8.0 * DBL_EPSILON * fabs(t) ? ns : t;
}

/* The instant of a clock after `ticks` of them. */
static double clock_instant(int k, double offset, double interval, double ticks)
{
    const double *const grid = CLOCKS[k].grid;
    return whole_ns(grid[2] > 0.0 ? (grid[0] + ticks * grid[1]) / grid[2]
                                  : offset + ticks * interval);
}

/* Whether the time `t` has come, rounding aside. */
static bool reached(double t, double now)
{
    return t <= now + larger(TIME_TOLERANCE, 8.0 * DBL_EPSILON * fabs(now));
}

/* Raise the flags of all clocks that tick now. next: the earliest instant to come, or infinity.
 * Returns whether any flag is raised; a negative number when an interval is not above zero.
 */
static int tick(Core *c, double *next, int *clock)
{
    double offset[N_CLOCKS + 1], interval[N_CLOCKS + 1];
    int raised = 0;
    *next = INFINITY;
    model_clocks(c->p, offset, interval);
    for (int k = 0; k < N_CLOCKS; k++) {
        *clock = k;
        if (!(interval[k] > 0.0) || !isfinite(interval[k]) || !isfinite(offset[k])) {
            return -1;
        }
        const double passed = ceil((c->t - offset[k]) / interval[k] - 1.0);
        double ticks = larger(c->ticks[k], passed);
        double instant = clock_instant(k, offset[k], interval[k], ticks);
        while (reached(instant, c->t)) {
            if (reached(c->t, instant)) {
                c->p[CLOCKS[k].flag] = 1.0;
                raised = 1;
            }
            ticks += 1.0;
            instant = clock_instant(k, offset[k], interval[k], ticks);
        }
        c->ticks[k] = ticks;
        *next = smaller(*next, instant);
    }
    return raised;
}

/* Find the initial values; clocks that tick at the beginning tick now. */
static SolverReport start(Core *c)
{
    double next;
    int clock = 0;
    const SolverReport settled = settle(c, true);
    if (settled.result != SOLVER_OK) {
        return settled;
    }
    const int ticked = tick(c, &next, &clock);
    if (ticked < 0) {
        return report(SOLVER_NO_INTERVAL, c->t, -1, CLOCKS[clock].place);
    }
    return ticked > 0 ? settle(c, false) : settled;
}

/* Advance to t_end. On failure the core rests where the last internal step began.
 *
 * Internal steps end on a grid from the beginning, also after an event between two of its points,
 * and at the instants of clocks.
 */
static SolverReport advance(Core *c, double t_end)
{
    double z0[N_RELATIONS + 1], z1[N_RELATIONS + 1], x1[N_X + 1];
    const double t_begin = c->t;
    double t_grid = t_begin, points = 0.0, t_clock = INFINITY;
    int events = 0, clock = 0;
    int ticked = tick(c, &t_clock, &clock);
    bool crossed = false;
    int relation = 0;
    for (;;) {
        if (ticked < 0) {
            return report(SOLVER_NO_INTERVAL, c->t, -1, CLOCKS[clock].place);
        }
        if (ticked > 0 || crossed) {
            const SolverReport settled = settle(c, false);
            if (settled.result != SOLVER_OK) {
                return settled;
            }
        }
        if (crossed && ++events > MAX_EVENTS) {
            return report(SOLVER_TOO_MANY_EVENTS, c->t, -1, RELATIONS[relation].place);
        }
        if (c->t >= t_end) {
            break;
        }
        model_relations(c->t, c->y, c->p, z0);
        while (t_grid <= c->t) {
            t_grid = whole_ns(t_begin + ++points * INTERNAL_STEP);
        }
        double t_next = t_end - t_grid < INTERNAL_STEP * 1e-6 ? t_end : t_grid;
        t_next = reached(t_clock, t_next) ? smaller(t_clock, t_end) : t_next;
        const double h = t_next - c->t; /* of the rounded times: their sum is exact */
        runge_kutta(c->t, c->y, c->p, h, x1);
        const int bad = not_finite(x1, N_X);
        if (bad >= 0) {
            return report(SOLVER_NOT_FINITE, t_next, bad, "");
        }
        model_relations(t_next, x1, c->p, z1);
        relation = first_contradiction(z1, c->p);
        crossed = relation >= 0;
        if (crossed) {
            const double inside = locate(c, h, z0, z1, x1);
            t_next = inside < h ? c->t + inside : t_next;
        }
        memcpy(c->y, x1, N_X * sizeof(double));
        c->t = t_next;
        ticked = reached(t_clock, t_next) ? tick(c, &t_clock, &clock) : 0;
    }
    model_algebraics(c->t, c->y, c->p);
    const int bad = not_finite(c->y, N_Y);
    return bad < 0 ? report(SOLVER_OK, c->t, -1, "") : report(SOLVER_NOT_FINITE, c->t, bad, "");
}
