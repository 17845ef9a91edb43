/* Integration with a fixed step, events located inside it.
 *
 * Between events every relation rests at its remembered value, so that the right-hand side is
 * smooth. After each internal step the functions of the relations are looked at: one that
 * contradicts its memory lies past an event. The earliest such instant is enclosed to
 * TIME_TOLERANCE, the state is taken just past it, and the discrete equations are iterated until
 * nothing changes. Where a right-hand side has a kink without being an event, the step ends too.
 */
#include <float.h>
#include <stdarg.h>
#include <stdio.h>
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
    double rest[N_X + 1];       /* of each state: what rounding has left out of it */
} Core;

/* text: what the model said, or what went wrong with time, names and place. */
typedef struct {
    SolverResult result;
    const char *text;
} SolverReport;

static const SolverReport FINE = {SOLVER_OK, ""};

static SolverReport failed(Notes *notes, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    vsnprintf(notes->text, sizeof notes->text, format, values);
    va_end(values);
    const SolverReport r = {SOLVER_FAILED, notes->text};
    return r;
}

/* A block of equations without a solution; `found`: 1 + its number. */
static SolverReport no_solution(const Core *c, int found, Notes *notes)
{
    const BlockInfo *const block = &BLOCKS[found - 1];
    return failed(notes, "%s: no solution of the equations for %s was found at t = %.12g s",
                  block->place, block->names, c->t);
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
    case SIGN:
        return sign(z);
    case ZERO_IS_FALSE:
        return z < 0.0 ? 1.0 : 0.0;
    case ZERO_IS_TRUE:
        return z <= 0.0 ? 1.0 : 0.0;
    default:
        break;
    }
    return z == 0.0 ? memory : z < 0.0 ? 1.0 : 0.0;
}

/* The value that the function of relation k passes on its way from its memory to z. */
static double boundary(int k, double z, const double *p)
{
    const double memory = RELATIONS[k].kind == KINK ? 0.0 : p[RELATIONS[k].memory];
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

/* A kink is passed when the function changes its sign; all others contradict their memory. */
static bool passed(int k, double z0, double z, const double *p)
{
    if (RELATIONS[k].kind == KINK) {
        return z0 * z < 0.0;
    }
    const double memory = p[RELATIONS[k].memory];
    return relation_value(k, z, memory) != memory;
}

/* The first relation that is passed between z0 and z, or -1. resting: kinks that do not count. */
static int first_passed(const double *z0, const double *z, const double *p, const bool *resting)
{
    for (int k = 0; k < N_RELATIONS; k++) {
        if (!(RELATIONS[k].kind == KINK && resting[k]) && passed(k, z0[k], z[k], p)) {
            return k;
        }
    }
    return -1;
}

/* A step of the classical fourth-order Runge-Kutta method; states are sums with compensation (W.
 * Kahan, Further remarks on reducing truncation errors, 1965). Returns 1 + number of a block
 * without a solution, or 0.
 */
static int runge_kutta(const Core *c, double h, double *x1, double *rest)
{
    const double *const x = c->y;
    double k1[N_X + 1], k2[N_X + 1], k3[N_X + 1], k4[N_X + 1], at[N_X + 1];
    int bad = model_derivatives(c->t, x, c->y, c->p, k1);
    for (int i = 0; i < N_X; i++) {
        at[i] = x[i] + 0.5 * h * k1[i];
    }
    bad = bad ? bad : model_derivatives(c->t + 0.5 * h, at, c->y, c->p, k2);
    for (int i = 0; i < N_X && !bad; i++) {
        at[i] = x[i] + 0.5 * h * k2[i];
    }
    bad = bad ? bad : model_derivatives(c->t + 0.5 * h, at, c->y, c->p, k3);
    for (int i = 0; i < N_X && !bad; i++) {
        at[i] = x[i] + h * k3[i];
    }
    bad = bad ? bad : model_derivatives(c->t + h, at, c->y, c->p, k4);
    for (int i = 0; i < N_X && !bad; i++) {
        const double change = h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]) + c->rest[i];
        x1[i] = x[i] + change;
        rest[i] = change - (x1[i] - x[i]);
    }
    return bad;
}

/* The first value that is not a finite number, or -1. */
static int not_finite(const double *values, int count)
{
    for (int i = 0; i < count; i++) {
        if (!isfinite(values[i])) {
            return i;
        }
    }
    return -1;
}

static SolverReport check_finite(const Core *c, const double *y, int count, double t, Notes *notes)
{
    const int bad = not_finite(y, count);
    if (bad >= 0) {
        return failed(notes, "%s is not a finite number at t = %.12g s", Y_NAMES[bad], t);
    }
    (void)c;
    return FINE;
}

/* Discrete variables: finite, whole ones within their type. */
static SolverReport check_discrete(const Core *c, Notes *notes)
{
    for (int k = 0; k < N_VARIABLES; k++) {
        const VariableInfo *const v = &VARIABLES[k];
        for (int i = 0; v->vector == IN_P && i < v->count; i++) {
            const double value = c->p[v->index + i];
            if (!isfinite(value) && v->class == CLASS_OUTPUT) {
                return failed(notes, "%s is not a finite number at t = %.12g s", v->name, c->t);
            }
            if (v->type == TYPE_INT32 && !(value >= INT32_MIN && value <= INT32_MAX)) {
                return failed(notes, "%s = %.17g is beyond a whole number of 32 bits at t = %.12g s",
                              v->name, value, c->t);
            }
        }
    }
    return FINE;
}

static int refresh_relations(Core *c)
{
    double z[N_RELATIONS + 1];
    const int bad = model_relations(c->t, c->y, c->y, c->p, z);
    for (int k = 0; k < N_RELATIONS && !bad; k++) {
        if (RELATIONS[k].kind != KINK) {
            double *memory = &c->p[RELATIONS[k].memory];
            *memory = relation_value(k, z[k], *memory);
        }
    }
    return bad;
}

static void set_initial_flag(Core *c, bool value)
{
#if INITIAL_FLAG >= 0
    c->p[INITIAL_FLAG] = value ? 1.0 : 0.0;
#endif
    (void)c, (void)value;
}

/* All equations once, with what was before the event at rest. */
static int evaluate(Core *c, bool at_start)
{
    int bad = at_start ? model_initial(c->t, c->y, c->p) : 0;
    bad = bad ? bad : model_algebraics(c->t, c->y, c->p);
    bad = bad ? bad : refresh_relations(c);
    if (bad) {
        return bad;
    }
    model_runtime(c->t, c->y, c->p);
    if (at_start) { /* only initial() is an edge now */
        set_initial_flag(c, false);
        model_conditions(c->t, c->y, c->p);
        set_initial_flag(c, true);
    }
    bad = model_updates(c->t, c->y, c->p, !at_start || INITIAL_FLAG >= 0);
    model_runtime(c->t, c->y, c->p);
    return bad;
}

/* Evaluate until nothing changes. */
static SolverReport agree(Core *c, bool at_start, Notes *notes)
{
    for (int i = 0; i < MAX_ITERATIONS; i++) {
        Core before;
        memcpy(&before, c, sizeof before);
        const int bad = evaluate(c, at_start);
        if (bad) {
            return no_solution(c, bad, notes);
        }
        if (memcmp(&before, c, sizeof before) == 0) {
            return FINE;
        }
    }
    return failed(notes, "discrete equations do not come to rest at t = %.12g s", c->t);
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

/* Bring all discrete variables into agreement at one instant: first all equations among each other,
 * then what was before the event follows, which may be a further event. reinit() acts between.
 */
static SolverReport settle(Core *c, bool at_start, Notes *notes)
{
    set_initial_flag(c, at_start);
    if (!at_start) {
        const int bad = model_entry(c->t, c->y, c->p);
        if (bad) {
            return no_solution(c, bad, notes);
        }
    }
    for (int i = 0; i < MAX_ITERATIONS; i++) {
        SolverReport r = agree(c, at_start && i == 0, notes);
        if (r.result != SOLVER_OK) {
            return r;
        }
        r.result = model_actions(c->t, c->y, c->p, at_start && i == 0, notes);
        if (r.result != SOLVER_OK) {
            r.text = notes->text;
            return r;
        }
        Core before;
        memcpy(&before, c, sizeof before);
        if (model_reinit(c->t, c->y, c->p)) {
            memset(c->rest, 0, sizeof c->rest);
        }
        remember(c);
        set_initial_flag(c, false);
        if (memcmp(&before, c, sizeof before) == 0) {
            r = check_finite(c, c->y, N_Y, c->t, notes);
            return r.result == SOLVER_OK ? check_discrete(c, notes) : r;
        }
    }
    return failed(notes, "discrete equations do not come to rest at t = %.12g s", c->t);
}

/* A trial: the states and the functions of the relations after a part of the step. */
typedef struct {
    double h;
    double x[N_X + 1], rest[N_X + 1], z[N_RELATIONS + 1];
} Trial;

static int try_step(const Core *c, double h, Trial *trial)
{
    trial->h = h;
    const int bad = runge_kutta(c, h, trial->x, trial->rest);
    return bad ? bad : model_relations(c->t + h, trial->x, c->y, c->p, trial->z);
}

/* Shorten the trial to just past the earliest relation that it passes; z0: functions at 0.
 *
 * The estimate is the secant of each such function; every third one is the middle, so that the
 * enclosure shrinks in any case.
 */
static int locate(const Core *c, const double *z0, const bool *resting, Trial *far)
{
    const double tolerance = larger(TIME_TOLERANCE, 4.0 * DBL_EPSILON * fabs(c->t));
    double low = 0.0, z_low[N_RELATIONS + 1];
    memcpy(z_low, z0, sizeof z_low);
    for (int n = 0; n < MAX_SEARCH && far->h - low > tolerance; n++) {
        double guess = far->h;
        for (int k = 0; k < N_RELATIONS; k++) {
            const bool counts = !(RELATIONS[k].kind == KINK && resting[k]);
            if (counts && passed(k, z0[k], far->z[k], c->p) && z_low[k] != far->z[k]) {
                const double from = z_low[k] - boundary(k, far->z[k], c->p);
                guess = smaller(guess, low + (far->h - low) * from / (z_low[k] - far->z[k]));
            }
        }
        if (n % 3 == 2) {
            guess = 0.5 * (low + far->h);
        }
        guess = larger(low + 0.5 * tolerance, smaller(guess, far->h - 0.5 * tolerance));
        Trial near;
        const int bad = try_step(c, guess, &near);
        if (bad) {
            return bad;
        }
        if (first_passed(z0, near.z, c->p, resting) < 0) {
            low = guess;
            memcpy(z_low, near.z, sizeof z_low);
        } else {
            *far = near;
        }
    }
    return 0;
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

static SolverReport no_interval(int clock, Notes *notes)
{
    return failed(notes, "the interval of a clock must be above zero, sample() at %s",
                  CLOCKS[clock].place);
}

/* Find the initial values; clocks that tick at the beginning tick now. */
static SolverReport start(Core *c, Notes *notes)
{
    double next;
    int clock = 0;
    const SolverReport settled = settle(c, true, notes);
    if (settled.result != SOLVER_OK) {
        return settled;
    }
    const int ticked = tick(c, &next, &clock);
    if (ticked < 0) {
        return no_interval(clock, notes);
    }
    return ticked > 0 ? settle(c, false, notes) : settled;
}

/* Advance to t_end. On failure the core rests where the last internal step began.
 *
 * Internal steps end on a grid from the beginning, also after an event between two of its points,
 * and at the instants of clocks.
 */
static SolverReport advance(Core *c, double t_end, Notes *notes)
{
    double z0[N_RELATIONS + 1];
    bool resting[N_RELATIONS + 1] = {false};
    const double t_begin = c->t;
    double t_grid = t_begin, points = 0.0, t_clock = INFINITY;
    int events = 0, clock = 0, relation = -1;
    int ticked = tick(c, &t_clock, &clock);
    for (;;) {
        const bool event = relation >= 0 && RELATIONS[relation].kind != KINK;
        if (ticked < 0) {
            return no_interval(clock, notes);
        }
        if (ticked > 0 || event) {
            const SolverReport settled = settle(c, false, notes);
            if (settled.result != SOLVER_OK) {
                return settled;
            }
        } else if (LARGEST_BLOCK > 0) { /* where the next search begins */
            const int bad = model_algebraics(c->t, c->y, c->p);
            if (bad) {
                return no_solution(c, bad, notes);
            }
        }
        if (event && ++events > MAX_EVENTS) {
            return failed(notes, "more than %d events in one step at t = %.12g s, relation at %s",
                          MAX_EVENTS, c->t, RELATIONS[relation].place);
        }
        if (c->t >= t_end) {
            break;
        }
        int bad = model_relations(c->t, c->y, c->y, c->p, z0);
        while (t_grid <= c->t) {
            t_grid = whole_ns(t_begin + ++points * INTERNAL_STEP);
            memset(resting, 0, sizeof resting);
        }
        double t_next = t_end - t_grid < INTERNAL_STEP * 1e-6 ? t_end : t_grid;
        t_next = reached(t_clock, t_next) ? smaller(t_clock, t_end) : t_next;
        Trial trial;
        bad = bad ? bad : try_step(c, t_next - c->t, &trial); /* the sum of both is exact */
        if (bad) {
            return no_solution(c, bad, notes);
        }
        const SolverReport finite = check_finite(c, trial.x, N_X, t_next, notes);
        if (finite.result != SOLVER_OK) {
            return finite;
        }
        relation = first_passed(z0, trial.z, c->p, resting);
        if (relation >= 0) {
            const double whole = trial.h;
            bad = locate(c, z0, resting, &trial);
            if (bad) {
                return no_solution(c, bad, notes);
            }
            relation = first_passed(z0, trial.z, c->p, resting);
            t_next = trial.h < whole ? c->t + trial.h : t_next;
        }
        for (int k = 0; k < N_RELATIONS && relation >= 0; k++) {
            if (passed(k, z0[k], trial.z[k], c->p)) {
                /* A kink ends a step once between two points of the grid; an event goes first. */
                resting[k] = RELATIONS[k].kind == KINK;
                relation = resting[k] ? relation : k;
            }
        }
        memcpy(c->y, trial.x, N_X * sizeof(double));
        memcpy(c->rest, trial.rest, N_X * sizeof(double));
        c->t = t_next;
        ticked = reached(t_clock, t_next) ? tick(c, &t_clock, &clock) : 0;
    }
    const int bad = model_algebraics(c->t, c->y, c->p);
    return bad ? no_solution(c, bad, notes) : check_finite(c, c->y, N_Y, c->t, notes);
}
