/* A co-simulation slave on top of solver.c, free of any version of FMI.
 *
 * fmi3.c and fmi2.c give it their names: they hand over calls and define `emit`, which logs. The
 * status words of both versions have the numbers of `Status`.
 */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#define MESSAGE_SIZE 1024

typedef enum { STATUS_OK, STATUS_WARNING, STATUS_DISCARD, STATUS_ERROR } Status;

/* INSTANTIATED and INITIALIZING: values may be set, nothing has moved. ENDED: the model has called
 * terminate(). FAILED: after an error of the equations; values can be read, nothing moves. */
typedef enum { INSTANTIATED, INITIALIZING, STEPPING, ENDED, FAILED, TERMINATED } Phase;
static const char *const PHASE_NAMES[] = {
    "before initialization", "in initialization", "between steps",
    "after the model has ended the simulation", "after an error", "after termination",
};

/* What a saved state holds. */
typedef struct {
    Core core;
    double stop_time; /* infinite when not given */
    int32_t phase;
    int32_t inputs_changed; /* y does not follow from p and the states at the moment */
} Saved;

typedef struct {
    Saved now;
    Core view; /* in initialization: what would hold if it ended now */
    char *name;
    void *environment;
    void (*log)(void); /* the importer's function, of a type that only its version knows */
    Notes notes;
    unsigned silent; /* bits of log categories that are switched off */
} Instance;

/* In the order of Status, from STATUS_WARNING. */
static const char *const CATEGORIES[] = {"logStatusWarning", "logStatusDiscard", "logStatusError"};
enum { N_CATEGORIES = sizeof CATEGORIES / sizeof CATEGORIES[0] };

static const char SERIAL_MARK[] = "axisrig state 3 " INSTANTIATION_TOKEN;
enum { SERIAL_SIZE = sizeof SERIAL_MARK + sizeof(Saved) };

/* Hand a text to the importer's logger. */
static void emit(const Instance *me, Status status, const char *category, const char *text);

static Status say(const Instance *me, Status status, const char *format, ...)
{
    const int category = (int)status - STATUS_WARNING;
    if (me->log != NULL && !(me->silent >> category & 1u)) {
        char text[MESSAGE_SIZE];
        va_list values;
        va_start(values, format);
        vsnprintf(text, sizeof text, format, values);
        va_end(values);
        emit(me, status, CATEGORIES[category], text);
    }
    return status;
}

#define fail(me, ...) say(me, STATUS_ERROR, __VA_ARGS__)

/* A call that has no place in the present phase. */
static Status misplaced(const Instance *me, const char *function)
{
    return fail(me, "%s cannot be called %s (t = %.12g s)", function, PHASE_NAMES[me->now.phase],
                me->now.core.t);
}

static Status tell(Instance *me, SolverReport r)
{
    const int shown = me->notes.warnings < N_WARNINGS ? me->notes.warnings : N_WARNINGS;
    for (int i = 0; i < shown; i++) {
        say(me, STATUS_WARNING, "%s", me->notes.warning[i]);
    }
    if (me->notes.warnings > shown) {
        say(me, STATUS_WARNING, "%d more warnings", me->notes.warnings - shown);
    }
    me->notes.warnings = 0;
    switch (r.result) {
    case SOLVER_OK:
        return shown > 0 ? STATUS_WARNING : STATUS_OK;
    case SOLVER_TERMINATED:
        return say(me, STATUS_DISCARD, "terminate: %s", r.text);
    case SOLVER_FAILED:
        break;
    }
    return fail(me, "%s", r.text);
}

/* The phase that follows from what the equations said. */
static Status concluded(Instance *me, SolverReport r)
{
    const Status status = tell(me, r);
    me->now.phase = status == STATUS_ERROR     ? FAILED
                    : status == STATUS_DISCARD ? ENDED
                                               : STEPPING;
    return status;
}

/* --- life ------------------------------------------------------------------------------- */

static void set_defaults(Instance *me)
{
    memset(&me->now, 0, sizeof me->now);
    memcpy(me->now.core.y, START_Y, sizeof START_Y);
    memcpy(me->now.core.p, START_P, sizeof START_P);
    me->now.stop_time = INFINITY;
    me->now.phase = INSTANTIATED;
    me->now.inputs_changed = true;
}

static void release(Instance *me)
{
    if (me != NULL) {
        free(me->name);
        free(me);
    }
}

/* A new instance, or NULL with a message. `token` is what the importer read from the description. */
static Instance *new_instance(const char *name, const char *token, void *environment,
                              void (*log)(void))
{
    Instance *const me = calloc(1, sizeof *me);
    if (me == NULL) {
        return NULL;
    }
    me->environment = environment;
    me->log = log;
    if (name == NULL || name[0] == '\0') {
        fail(me, "an instance needs a name");
    } else if (token == NULL || strcmp(token, INSTANTIATION_TOKEN) != 0) {
        fail(me, "%s: the instantiation token \"%s\" is not that of this FMU, \"%s\"", name,
             token == NULL ? "" : token, INSTANTIATION_TOKEN);
    } else {
        const size_t size = strlen(name) + 1;
        me->name = malloc(size);
        if (me->name != NULL) {
            memcpy(me->name, name, size);
            set_defaults(me);
            return me;
        }
    }
    release(me);
    return NULL;
}

static Status choose_categories(Instance *me, bool on, size_t count, const char *const names[])
{
    unsigned chosen = count == 0 ? ~0u : 0u;
    for (size_t i = 0; i < count; i++) {
        int k = 0;
        while (k < N_CATEGORIES && (names[i] == NULL || strcmp(names[i], CATEGORIES[k]) != 0)) {
            k++;
        }
        if (k == N_CATEGORIES) {
            return fail(me, "log category %s is not known", names[i] == NULL ? "" : names[i]);
        }
        chosen |= 1u << k;
    }
    me->silent = on ? me->silent & ~chosen : me->silent | chosen;
    return STATUS_OK;
}

static Status set_times(Instance *me, double start, bool stop_defined, double stop)
{
    if (!isfinite(start)) {
        return fail(me, "start time is not a finite number");
    }
    if (stop_defined && !(stop > start)) {
        return fail(me, "stop time %.12g s does not lie behind the start time %.12g s", stop, start);
    }
    me->now.core.t = start;
    me->now.stop_time = stop_defined ? stop : INFINITY;
    return STATUS_OK;
}

static Status exit_initialization(Instance *me)
{
    me->now.inputs_changed = false;
    return concluded(me, start(&me->now.core, &me->notes));
}

/* --- values ----------------------------------------------------------------------------- */

static const VariableInfo *find(const Instance *me, uint32_t reference, VariableType type)
{
    if (reference >= N_VARIABLES) {
        fail(me, "value reference %u is not known", (unsigned)reference);
        return NULL;
    }
    if (VARIABLES[reference].type != type) {
        fail(me, "%s is of another type", VARIABLES[reference].name);
        return NULL;
    }
    return &VARIABLES[reference];
}

/* Where values are read: what was set since the last step is in force there. NULL on failure. */
static const Core *readable(Instance *me, const char *function)
{
    if (me->now.phase == INSTANTIATED) {
        misplaced(me, function);
        return NULL;
    }
    if (me->now.phase == INITIALIZING) {
        /* More may be set before the start: look at a copy. */
        if (me->now.inputs_changed) {
            memcpy(&me->view, &me->now.core, sizeof me->view);
            if (tell(me, start(&me->view, &me->notes)) == STATUS_ERROR) {
                return NULL;
            }
            me->now.inputs_changed = false;
        }
        return &me->view;
    }
    if (me->now.inputs_changed && me->now.phase == STEPPING) {
        model_algebraics(me->now.core.t, me->now.core.y, me->now.core.p);
    }
    return &me->now.core;
}

static const double *place_of(const Core *core, const VariableInfo *variable)
{
    return variable->vector == IS_TIME ? &core->t
         : variable->vector == IN_Y    ? &core->y[variable->index]
                                       : &core->p[variable->index];
}

/* Whether a variable may be set now; a message when not. */
static Status settable(const Instance *me, const VariableInfo *variable)
{
    if (variable->class == CLASS_OUTPUT) {
        return fail(me, "%s cannot be set", variable->name);
    }
    switch ((Phase)me->now.phase) {
    case INSTANTIATED:
    case INITIALIZING:
        return STATUS_OK;
    case STEPPING:
        if (variable->class == CLASS_INPUT) {
            return STATUS_OK;
        }
        return fail(me, "%s can only be set before the start", variable->name);
    default:
        return fail(me, "%s cannot be set %s", variable->name, PHASE_NAMES[me->now.phase]);
    }
}

/* Whether the equations hold the start value of a slot of p instead of reading it. */
static bool is_folded(int slot)
{
    int k = 0;
    while (FOLDED[k] >= 0 && FOLDED[k] != slot) {
        k++;
    }
    return FOLDED[k] == slot;
}

static Status set_element(Instance *me, const VariableInfo *variable, size_t element, double value)
{
    if (!isfinite(value) || value < variable->min || value > variable->max) {
        return fail(me, "%s = %.12g is outside %.12g .. %.12g (t = %.12g s)", variable->name, value,
                    variable->min, variable->max, me->now.core.t);
    }
    const int slot = variable->index + (int)element;
    if (variable->vector == IN_P && value != START_P[slot] && is_folded(slot)) {
        return fail(me, "%s = %.12g has no effect in this FMU: the compiler has used its value %.12g",
                    variable->name, value, START_P[slot]);
    }
    Core *const core = &me->now.core;
    (variable->vector == IN_Y ? core->y : core->p)[slot] = value;
    me->now.inputs_changed = true;
    return STATUS_OK;
}

/* Get and set of one type. The values of an array stand one after the other. */
#define VALUES(Name, Type, KIND, FROM_DOUBLE, TO_DOUBLE)                                           \
    static Status get_##Name(Instance *me, const char *function, const uint32_t references[],      \
                             size_t n_references, Type values[], size_t n_values)                  \
    {                                                                                              \
        const Core *const core = readable(me, function);                                           \
        size_t done = 0;                                                                           \
        if (core == NULL) {                                                                        \
            return STATUS_ERROR;                                                                   \
        }                                                                                          \
        for (size_t i = 0; i < n_references; i++) {                                                \
            const VariableInfo *const variable = find(me, references[i], KIND);                    \
            if (variable == NULL) {                                                                \
                return STATUS_ERROR;                                                               \
            }                                                                                      \
            const double *const place = place_of(core, variable);                                  \
            if (n_values - done < (size_t)variable->count) {                                       \
                return fail(me, "%s: fewer values than the variables have", function);             \
            }                                                                                      \
            for (int k = 0; k < variable->count; k++) {                                            \
                values[done++] = FROM_DOUBLE(place[k]);                                            \
            }                                                                                      \
        }                                                                                          \
        return done == n_values ? STATUS_OK                                                        \
                                : fail(me, "%s: more values than the variables have", function);   \
    }                                                                                              \
    static Status set_##Name(Instance *me, const char *function, const uint32_t references[],      \
                             size_t n_references, const Type values[], size_t n_values)            \
    {                                                                                              \
        size_t done = 0;                                                                           \
        for (size_t i = 0; i < n_references; i++) {                                                \
            const VariableInfo *const variable = find(me, references[i], KIND);                    \
            if (variable == NULL || settable(me, variable) != STATUS_OK) {                         \
                return STATUS_ERROR;                                                               \
            }                                                                                      \
            if (n_values - done < (size_t)variable->count) {                                       \
                return fail(me, "%s: fewer values than the variables have", function);             \
            }                                                                                      \
            for (int k = 0; k < variable->count; k++) {                                            \
                const double value = TO_DOUBLE values[done++];                                     \
                if (set_element(me, variable, (size_t)k, value) != STATUS_OK) {                    \
                    return STATUS_ERROR;                                                           \
                }                                                                                  \
            }                                                                                      \
        }                                                                                          \
        return done == n_values ? STATUS_OK                                                        \
                                : fail(me, "%s: more values than the variables have", function);   \
    }

/* --- steps ------------------------------------------------------------------------------ */

/* Advance to begin + size. STATUS_DISCARD: the model has ended the simulation at the core's time.
 *
 * `begin` is what the importer holds for the present time; a difference by rounding does not
 * count, the step ends at the importer's end of it. */
static Status step(Instance *me, const char *function, double begin, double size)
{
    Core *const core = &me->now.core;
    if (me->now.phase != STEPPING) {
        return me->now.phase == ENDED ? STATUS_DISCARD : misplaced(me, function);
    }
    const double room = 1e-9 + 1e-12 * fabs(core->t);
    if (!(fabs(begin - core->t) <= room)) {
        return fail(me, "%s: at t = %.12g s, not %.12g s", function, core->t, begin);
    }
    const double end = whole_ns(begin + size);
    if (!(size > 0.0) || !isfinite(end)) {
        return fail(me, "%s: step size %.12g s at t = %.12g s", function, size, begin);
    }
    if (end > me->now.stop_time + room) {
        return fail(me, "%s: %.12g s lies behind the stop time %.12g s", function, end,
                    me->now.stop_time);
    }
    if (fabs(end) * (16.0 * DBL_EPSILON) > INTERNAL_STEP) {
        return fail(me, "%s: at t = %.12g s the internal step of %g s is lost in rounding",
                    function, end, INTERNAL_STEP);
    }
    if (me->now.inputs_changed) {
        me->now.inputs_changed = false;
        const Status settled = concluded(me, settle(core, false, &me->notes));
        if (settled > STATUS_WARNING) {
            return settled;
        }
        const Status status = concluded(me, advance(core, end, &me->notes));
        return status > settled ? status : settled;
    }
    return concluded(me, advance(core, end, &me->notes));
}

/* --- steps in a row --------------------------------------------------------------------- */

/* Beyond FMI: several steps in one call, with inputs before and outputs after each of them. It does
 * what the functions of FMI do one by one, and stops where one of them fails: outputs are finite
 * then, since a step that leads to others is an error. An importer that does not know it misses
 * nothing. A change of the structure needs another name of the function.
 */
typedef struct {
    int64_t begin_ns; /* of the first step; of the next one when the call returns */
    int64_t count, done;
    const int64_t *ends_ns;
    int64_t n_inputs, n_outputs; /* scalars of type Float64 */
    const uint32_t *inputs, *outputs;
    const double *given; /* a row for each step */
    double *got;         /* the same */
} StepsInARow;

#if defined _WIN32
#define EXPORTED __declspec(dllexport)
#else
#define EXPORTED __attribute__((visibility("default")))
#endif

static Status set_reals(Instance *me, const uint32_t references[], int64_t count,
                        const double values[])
{
    for (int64_t i = 0; i < count; i++) {
        const VariableInfo *const variable = find(me, references[i], TYPE_FLOAT64);
        if (variable == NULL || settable(me, variable) != STATUS_OK
            || set_element(me, variable, 0, values[i]) != STATUS_OK) {
            return STATUS_ERROR;
        }
    }
    return STATUS_OK;
}

static Status get_reals(Instance *me, const uint32_t references[], int64_t count, double values[])
{
    const Core *const core = readable(me, "axisrigSteps1");
    for (int64_t i = 0; i < count && core != NULL; i++) {
        const VariableInfo *const variable = find(me, references[i], TYPE_FLOAT64);
        if (variable == NULL) {
            return STATUS_ERROR;
        }
        values[i] = *place_of(core, variable);
    }
    return core == NULL ? STATUS_ERROR : STATUS_OK;
}

EXPORTED int axisrigSteps1(void *instance, StepsInARow *row)
{
    Instance *const me = instance;
    Status worst = STATUS_OK;
    row->done = 0;
    while (me != NULL && row->done < row->count) {
        const int64_t k = row->done, end_ns = row->ends_ns[k];
        Status now = set_reals(me, row->inputs, row->n_inputs, row->given + k * row->n_inputs);
        if (now == STATUS_OK) {
            now = step(me, "axisrigSteps1", (double)row->begin_ns * 1e-9,
                       (double)(end_ns - row->begin_ns) * 1e-9);
        }
        if (now > STATUS_WARNING) {
            return now;
        }
        if (get_reals(me, row->outputs, row->n_outputs, row->got + k * row->n_outputs)
            != STATUS_OK) {
            return STATUS_ERROR;
        }
        worst = now > worst ? now : worst;
        row->begin_ns = end_ns;
        row->done++;
    }
    return me == NULL ? STATUS_ERROR : worst;
}

/* --- states ----------------------------------------------------------------------------- */

static Status save(const Instance *me, void **state)
{
    if (*state == NULL) {
        *state = malloc(sizeof(Saved));
        if (*state == NULL) {
            return fail(me, "no memory for the state");
        }
    }
    memcpy(*state, &me->now, sizeof(Saved));
    return STATUS_OK;
}

static Status restore(Instance *me, const char *function, const void *state)
{
    if (state == NULL) {
        return fail(me, "%s: no state", function);
    }
    memcpy(&me->now, state, sizeof(Saved));
    if (me->now.phase == INITIALIZING) {
        me->now.inputs_changed = true; /* the view belongs to what was before */
    }
    return STATUS_OK;
}

static void release_state(void **state)
{
    if (state != NULL) {
        free(*state);
        *state = NULL;
    }
}

static Status serialize(const Instance *me, const char *function, const void *state, void *bytes,
                        size_t size)
{
    if (state == NULL || size < SERIAL_SIZE) {
        return fail(me, "%s: no state, or fewer than %d bytes for it", function, (int)SERIAL_SIZE);
    }
    memcpy(bytes, SERIAL_MARK, sizeof SERIAL_MARK);
    memcpy((char *)bytes + sizeof SERIAL_MARK, state, sizeof(Saved));
    return STATUS_OK;
}

static Status deserialize(const Instance *me, const char *function, const void *bytes, size_t size,
                          void **state)
{
    if (size < SERIAL_SIZE || memcmp(bytes, SERIAL_MARK, sizeof SERIAL_MARK) != 0) {
        return fail(me, "%s: the bytes are not a state of this FMU", function);
    }
    const Status status = save(me, state); /* brings the memory */
    if (status == STATUS_OK) {
        memcpy(*state, (const char *)bytes + sizeof SERIAL_MARK, sizeof(Saved));
    }
    return status;
}
