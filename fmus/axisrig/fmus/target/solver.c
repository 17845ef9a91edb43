/* Integration with internal steps, events located inside them.
 *
 * Between events every relation rests at its remembered value, so that the right-hand side is
 * smooth. After each internal step the functions of the relations are looked at: one that
 * contradicts its memory lies past an event. The earliest such instant is enclosed to
 * TIME_TOLERANCE, the state is taken just past it, and the discrete equations are iterated until
 * nothing changes. Where the error estimate is too large, as at a kink or in a fast transition, an
 * internal step is cut.
 */
#include <float.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define TIME_TOLERANCE 1e-11 /* s */
#define MAX_SEARCH 200       /* evaluations to enclose one event */
#define MAX_ITERATIONS 100   /* of the discrete equations at one instant */
#define MAX_EVENTS 10000     /* in one communication step */
#define RELATIVE 1e-9        /* error of a state in one step, in terms of it */
#define ABSOLUTE 1e-12       /* the same near zero, in the unit of the state */
#define SMALLEST_PART 0.0001 /* of an internal step; shorter ones are taken as they are */

/* The last event at which a state has jumped. Numbers of any kind are held as double, so that a
 * Core has no gaps and can be compared as a whole.
 */
typedef struct {
    double t;
    double relation; /* 1 + the number of the relation that was passed; 0: none */
    double memory;   /* of that relation since then */
    double z;        /* its function there */
    double row;      /* events of the same relation before it, each within an internal step */
} Jump;

/* Everything that an instance remembers between two calls. */
typedef struct {
    double t;
    double y[N_Y + 1];
    double p[N_P + 1];
    double ticks[N_CLOCKS + 1]; /* instants of each clock that have passed */
    double rest[N_X + 1];       /* of each state: what rounding has left out of it */
    Jump jump;
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
static inline double relation_value(int k, double z, double memory)
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
    const double memory = p[RELATIONS[k].memory];
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

static inline bool passed(int k, double z, const double *p)
{
    const double memory = p[RELATIONS[k].memory];
    return relation_value(k, z, memory) != memory;
}

/* The first relation that contradicts its memory, or -1. */
static int first_passed(const double *z, const double *p)
{
    for (int k = 0; k < N_RELATIONS; k++) {
        if (passed(k, z[k], p)) {
            return k;
        }
    }
    return -1;
}

/* A trial: states, their derivatives and the functions of the relations after a step of h. error:
 * of the states in terms of what is allowed.
 */
typedef struct {
    double h, error;
    double x[N_X + 1], rest[N_X + 1], slope[N_X + 1], z[N_RELATIONS + 1];
} Trial;

/* A step of the method of Dormand and Prince, order 5 with an estimate of order 4 (J. Dormand, P.
 * Prince, A family of embedded Runge-Kutta formulae, 1980); states are sums with compensation (W.
 * Kahan, Further remarks on reducing truncation errors, 1965). k1: the derivatives at the begin.
 * Returns 1 + number of a block without a solution, or 0.
 */
static int runge_kutta(const Core *c, const double *k1, double h, Trial *trial)
{
    const double *const x = c->y, *const p = c->p;
    const double t = c->t;
    double k2[N_X + 1], k3[N_X + 1], k4[N_X + 1], k5[N_X + 1], k6[N_X + 1], at[N_X + 1];
    int bad = 0;
    for (int i = 0; i < N_X; i++) {
        at[i] = x[i] + h * (1.0 / 5.0 * k1[i]);
    }
    bad = model_derivatives(t + h / 5.0, at, c->y, p, k2);
    for (int i = 0; i < N_X && !bad; i++) {
        at[i] = x[i] + h * (3.0 / 40.0 * k1[i] + 9.0 / 40.0 * k2[i]);
    }
    bad = bad ? bad : model_derivatives(t + 3.0 / 10.0 * h, at, c->y, p, k3);
    for (int i = 0; i < N_X && !bad; i++) {
        at[i] = x[i] + h * (44.0 / 45.0 * k1[i] - 56.0 / 15.0 * k2[i] + 32.0 / 9.0 * k3[i]);
    }
    bad = bad ? bad : model_derivatives(t + 4.0 / 5.0 * h, at, c->y, p, k4);
    for (int i = 0; i < N_X && !bad; i++) {
        at[i] = x[i] + h * (19372.0 / 6561.0 * k1[i] - 25360.0 / 2187.0 * k2[i]
                            + 64448.0 / 6561.0 * k3[i] - 212.0 / 729.0 * k4[i]);
    }
    bad = bad ? bad : model_derivatives(t + 8.0 / 9.0 * h, at, c->y, p, k5);
    for (int i = 0; i < N_X && !bad; i++) {
        at[i] = x[i] + h * (9017.0 / 3168.0 * k1[i] - 355.0 / 33.0 * k2[i]
                            + 46732.0 / 5247.0 * k3[i] + 49.0 / 176.0 * k4[i]
                            - 5103.0 / 18656.0 * k5[i]);
    }
    bad = bad ? bad : model_derivatives(t + h, at, c->y, p, k6);
    for (int i = 0; i < N_X && !bad; i++) {
        const double change = h * (35.0 / 384.0 * k1[i] + 500.0 / 1113.0 * k3[i]
                                   + 125.0 / 192.0 * k4[i] - 2187.0 / 6784.0 * k5[i]
                                   + 11.0 / 84.0 * k6[i]) + c->rest[i];
        trial->x[i] = x[i] + change;
        trial->rest[i] = change - (trial->x[i] - x[i]);
    }
    double *const k7 = trial->slope;
    bad = bad ? bad : model_derivatives(t + h, trial->x, c->y, p, k7);
    trial->error = 0.0;
    for (int i = 0; i < N_X && !bad; i++) {
        const double error = h * (71.0 / 57600.0 * k1[i] - 71.0 / 16695.0 * k3[i]
                                  + 71.0 / 1920.0 * k4[i] - 17253.0 / 339200.0 * k5[i]
                                  + 22.0 / 525.0 * k6[i] - 1.0 / 40.0 * k7[i]);
        const double allowed = ABSOLUTE + RELATIVE * fabs(trial->x[i]);
        const double share = fabs(error) / allowed;
        trial->error = share <= trial->error ? trial->error : share; /* also where it is no number */
    }
    return bad;
}

/* The step that would just keep the error allowed, from one whose error is known. */
static double fitting(double h, double error)
{
    const double factor = isfinite(error) ? 0.9 * pow(larger(error, 1e-5), -0.2) : 0.1;
    return h * larger(0.1, smaller(factor, 5.0));
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

static SolverReport check_finite(const double *y, int count, double t, Notes *notes)
{
    const int bad = not_finite(y, count);
    if (bad >= 0) {
        return failed(notes, "%s is not a finite number at t = %.12g s", Y_NAMES[bad], t);
    }
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
        double *memory = &c->p[RELATIONS[k].memory];
        *memory = relation_value(k, z[k], *memory);
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

/* Whether a further evaluation would give the same bits: it is one of the time, the states and p
 * alone, and these are as before. Only blocks that are searched for read an earlier solution too.
 */
static bool would_repeat(const Core *before, const Core *c)
{
    return LARGEST_BLOCK == 0 && memcmp(before->p, c->p, sizeof c->p) == 0
        && memcmp(before->y, c->y, N_X * sizeof c->y[0]) == 0;
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
        if (memcmp(&before, c, sizeof before) == 0 || (!at_start && would_repeat(&before, c))) {
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
        if (model_reinit(c->t, c->y, c->p) && memcmp(before.y, c->y, sizeof before.y) != 0) {
            memset(c->rest, 0, sizeof c->rest);
            notes->reinits++;
        }
        remember(c);
        set_initial_flag(c, false);
        if (memcmp(&before, c, sizeof before) == 0) {
            r = check_finite(c->y, N_Y, c->t, notes);
            return r.result == SOLVER_OK ? check_discrete(c, notes) : r;
        }
    }
    return failed(notes, "discrete equations do not come to rest at t = %.12g s", c->t);
}

static int try_step(const Core *c, const double *slope, double h, Trial *trial)
{
    trial->h = h;
    const int bad = runge_kutta(c, slope, h, trial);
    return bad ? bad : model_relations(c->t + h, trial->x, c->y, c->p, trial->z);
}

static int count_passed(const double *z, const double *p)
{
    int count = 0;
    for (int k = 0; k < N_RELATIONS; k++) {
        count += passed(k, z[k], p) ? 1 : 0;
    }
    return count;
}

/* Relations that only rounding keeps apart are one event: move the trial past those that follow
 * within the tolerance.
 */
static int include_others(const Core *c, const double *slope, double tolerance, double whole,
                          Trial *far)
{
    Trial later;
    if (far->h + tolerance >= whole) {
        return 0;
    }
    const int bad = try_step(c, slope, far->h + tolerance, &later);
    if (!bad && count_passed(later.z, c->p) > count_passed(far->z, c->p)) {
        *far = later;
    }
    return bad;
}

/* Shorten the trial to just past the earliest relation that it passes; z0: functions at 0.
 *
 * The estimate is the secant of each such function; every third one is the middle, so that the
 * enclosure shrinks in any case.
 */
static int locate(const Core *c, const double *slope, const double *z0, Trial *far)
{
    const double tolerance = larger(TIME_TOLERANCE, 4.0 * DBL_EPSILON * fabs(c->t));
    const double whole = far->h;
    double low = 0.0, z_low[N_RELATIONS + 1];
    memcpy(z_low, z0, sizeof z_low);
    for (int n = 0; n < MAX_SEARCH && far->h - low > tolerance; n++) {
        double guess = far->h;
        for (int k = 0; k < N_RELATIONS; k++) {
            if (passed(k, far->z[k], c->p) && z_low[k] != far->z[k]) {
                const double from = z_low[k] - boundary(k, far->z[k], c->p);
                guess = smaller(guess, low + (far->h - low) * from / (z_low[k] - far->z[k]));
            }
        }
        if (n % 3 == 2) {
            guess = 0.5 * (low + far->h);
        }
        guess = larger(low + 0.5 * tolerance, smaller(guess, far->h - 0.5 * tolerance));
        Trial near;
        const int bad = try_step(c, slope, guess, &near);
        if (bad) {
            return bad;
        }
        if (first_passed(near.z, c->p) < 0) {
            low = guess;
            memcpy(z_low, near.z, sizeof z_low);
        } else {
            *far = near;
        }
    }
    return N_RELATIONS > 1 ? include_others(c, slope, tolerance, whole, far) : 0;
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

/* A relation that only rounding keeps apart from the tick of a clock belongs to it: where one passes
 * within the tolerance, the states are those of that moment.
 */
static int look_ahead(const Core *c, double t, Trial *trial, int *relation)
{
    double x[N_X + 1], z[N_RELATIONS + 1];
    for (int i = 0; i < N_X; i++) {
        x[i] = trial->x[i] + TIME_TOLERANCE * trial->slope[i];
    }
    const int bad = model_relations(t, x, c->y, c->p, z);
    if (!bad) {
        *relation = first_passed(z, c->p);
    }
    if (!bad && *relation >= 0) {
        memcpy(trial->x, x, N_X * sizeof *x);
        memcpy(trial->z, z, sizeof z);
    }
    return bad;
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

/* Note that a state has jumped as relation k was passed; z: the functions there. */
static void note_jump(Core *c, int k, const double *z)
{
    const bool again = c->jump.relation == k + 1.0 && c->t - c->jump.t < INTERNAL_STEP;
    const Jump jump = {c->t, k + 1.0, c->p[RELATIONS[k].memory], z[k],
                       again ? c->jump.row + 1.0 : 0.0};
    c->jump = jump;
}

/* Whether a step without an event leads on beyond the relation of jumps in a row: the next return
 * was too short to be seen, as when bounces pile up, and all later values would be wrong. A model
 * that comes to rest by itself stays where it is.
 */
static bool falls_through(const Core *c, const double *z)
{
    const Jump *const jump = &c->jump;
    if (jump->row < 1.0 || c->t - jump->t >= INTERNAL_STEP) {
        return false;
    }
    const int k = (int)jump->relation - 1;
    return RELATIONS[k].kind <= ZERO_KEEPS && c->p[RELATIONS[k].memory] == jump->memory
        && fabs(z[k]) > fabs(jump->z) && !passed(k, z[k], c->p);
}

/* Advance to t_end. On failure the core rests where the last internal step began.
 *
 * Internal steps end on a grid from the beginning, also after an event between two of its points,
 * and at the instants of clocks.
 */
static SolverReport advance(Core *c, double t_end, Notes *notes)
{
    double z0[N_RELATIONS + 1], slope[N_X + 1];
    const double t_begin = c->t;
    double t_grid = t_begin, points = 0.0, t_clock = INFINITY, h_next = INFINITY;
    int events = 0, clock = 0, relation = -1;
    int ticked = tick(c, &t_clock, &clock);
    bool jumped = c->jump.relation > 0.0 && c->jump.t == c->t;
    bool fresh = true; /* slope and z0 are not those of c */
    for (;;) {
        if (ticked < 0) {
            return no_interval(clock, notes);
        }
        if (ticked > 0 || relation >= 0) {
            const int jumps = notes->reinits;
            const SolverReport settled = settle(c, false, notes);
            if (settled.result != SOLVER_OK) {
                return settled;
            }
            fresh = true;
            if (relation >= 0 && notes->reinits > jumps) {
                note_jump(c, relation, z0);
                jumped = true;
            }
        } else if (LARGEST_BLOCK > 0) { /* where the next search begins */
            const int bad = model_algebraics(c->t, c->y, c->p);
            if (bad) {
                return no_solution(c, bad, notes);
            }
        }
        if (relation >= 0 && ++events > MAX_EVENTS) {
            return failed(notes, "more than %d events in one step at t = %.12g s, relation at %s",
                          MAX_EVENTS, c->t, RELATIONS[relation].place);
        }
        if (c->t >= t_end) {
            break;
        }
        int bad = 0;
        if (fresh) {
            bad = model_relations(c->t, c->y, c->y, c->p, z0);
            bad = bad ? bad : model_derivatives(c->t, c->y, c->y, c->p, slope);
            fresh = false;
        }
        while (t_grid <= c->t) {
            t_grid = whole_ns(t_begin + ++points * INTERNAL_STEP);
            h_next = INFINITY;
        }
        h_next = jumped ? SMALLEST_PART * INTERNAL_STEP : h_next; /* it may come back at once */
        jumped = false;
        double t_next = t_end - t_grid < INTERNAL_STEP * 1e-6 ? t_end : t_grid;
        t_next = reached(t_clock, t_next) ? smaller(t_clock, t_end) : t_next;
        const double shortest =
            larger(SMALLEST_PART * INTERNAL_STEP, 4.0 * DBL_EPSILON * fabs(c->t));
        h_next = larger(h_next, shortest);
        if (h_next < 0.9 * (t_next - c->t)) {
            t_next = c->t + h_next;
        }
        Trial trial;
        bad = bad ? bad : try_step(c, slope, t_next - c->t, &trial); /* the sum of both is exact */
        if (bad) {
            return no_solution(c, bad, notes);
        }
        const bool whole_step = trial.error <= 1.0 && t_next >= t_grid;
        h_next = whole_step ? INFINITY : fitting(trial.h, trial.error);
        if (!(trial.error <= 1.0) && trial.h > 1.5 * shortest) {
            relation = -1;
            ticked = 0;
            continue; /* with a shorter one */
        }
        const SolverReport finite = check_finite(trial.x, N_X, t_next, notes);
        if (finite.result != SOLVER_OK) {
            return finite;
        }
        relation = first_passed(trial.z, c->p);
        if (relation >= 0) {
            const double whole = trial.h;
            bad = locate(c, slope, z0, &trial);
            if (bad) {
                return no_solution(c, bad, notes);
            }
            relation = first_passed(trial.z, c->p);
            t_next = trial.h < whole ? c->t + trial.h : t_next;
            h_next = INFINITY; /* the equations may be others now */
        }
        if (relation < 0 && N_RELATIONS > 0 && reached(t_clock, t_next)) {
            bad = look_ahead(c, t_next, &trial, &relation);
            if (bad) {
                return no_solution(c, bad, notes);
            }
        }
        if (relation < 0 && falls_through(c, trial.z)) {
            return failed(notes, "%s: events with reinit() follow each other without end at "
                          "t = %.12g s, %d of them in this step",
                          RELATIONS[(int)c->jump.relation - 1].place, c->t, events);
        }
        memcpy(c->y, trial.x, N_X * sizeof(double));
        memcpy(c->rest, trial.rest, N_X * sizeof(double));
        memcpy(slope, trial.slope, N_X * sizeof(double));
        memcpy(z0, trial.z, sizeof z0);
        c->t = t_next;
        ticked = reached(t_clock, t_next) ? tick(c, &t_clock, &clock) : 0;
    }
    const int bad = model_algebraics(c->t, c->y, c->p);
    return bad ? no_solution(c, bad, notes) : check_finite(c->y, N_Y, c->t, notes);
}
