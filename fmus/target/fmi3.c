/* FMI 3.0 co-simulation on top of solver.c. Source: FMI specification 3.0.2, section 4. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "fmi3Functions.h"

#define MESSAGE_SIZE 512

typedef enum { INSTANTIATED, INITIALIZING, STEPPING, TERMINATED } Phase;

/* What fmi3GetFMUState copies. */
typedef struct {
    Core core;
    double stop_time; /* infinite when not given */
    int32_t phase;
    int32_t inputs_changed; /* y does not follow from p and the states at the moment */
} Saved;

typedef struct {
    Saved now;
    char *name;
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback log;
} Instance;

static const char SERIAL_MARK[] = "axisrig state 1 " INSTANTIATION_TOKEN;

static fmi3Status fail(const Instance *instance, const char *format, ...)
{
    if (instance->log != NULL) {
        char text[MESSAGE_SIZE];
        va_list values;
        va_start(values, format);
        vsnprintf(text, sizeof text, format, values);
        va_end(values);
        instance->log(instance->environment, fmi3Error, "logStatusError", text);
    }
    return fmi3Error;
}

static fmi3Status tell(const Instance *instance, SolverReport r)
{
    switch (r.result) {
    case SOLVER_OK:
        return fmi3OK;
    case SOLVER_NOT_FINITE:
        return fail(instance, "%s is not a finite number at t = %.12g s", Y_NAMES[r.state], r.t);
    case SOLVER_NO_FIXED_POINT:
        return fail(instance, "discrete equations do not come to rest at t = %.12g s", r.t);
    case SOLVER_TOO_MANY_EVENTS:
        return fail(instance, "more than %d events in one step at t = %.12g s, relation at %s",
                    MAX_EVENTS, r.t, r.text);
    case SOLVER_ASSERTION:
        return fail(instance, "%s (t = %.12g s)", r.text, r.t);
    }
    return fmi3Error;
}

static void set_defaults(Instance *instance)
{
    memset(&instance->now, 0, sizeof instance->now);
    memcpy(instance->now.core.y, START_Y, sizeof START_Y);
    memcpy(instance->now.core.p, START_P, sizeof START_P);
    instance->now.stop_time = INFINITY;
    instance->now.phase = INSTANTIATED;
    instance->now.inputs_changed = true;
}

/* --- life ------------------------------------------------------------------------------- */

const char *fmi3GetVersion(void) { return fmi3Version; }

fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean loggingOn, size_t nCategories,
                               const fmi3String categories[])
{
    (void)loggingOn;
    for (size_t i = 0; i < nCategories; i++) {
        if (strcmp(categories[i], "logStatusError") != 0) {
            return fail(instance, "log category %s is not known", categories[i]);
        }
    }
    return fmi3OK;
}

fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String instanceName, fmi3String instantiationToken, fmi3String resourcePath,
    fmi3Boolean visible, fmi3Boolean loggingOn, fmi3Boolean eventModeUsed,
    fmi3Boolean earlyReturnAllowed, const fmi3ValueReference requiredIntermediateVariables[],
    size_t nRequiredIntermediateVariables, fmi3InstanceEnvironment instanceEnvironment,
    fmi3LogMessageCallback logMessage, fmi3IntermediateUpdateCallback intermediateUpdate)
{
    (void)resourcePath, (void)visible, (void)loggingOn, (void)earlyReturnAllowed;
    (void)requiredIntermediateVariables, (void)intermediateUpdate;
    Instance *instance = calloc(1, sizeof *instance);
    if (instance == NULL) {
        return NULL;
    }
    instance->environment = instanceEnvironment;
    instance->log = logMessage;
    if (instantiationToken == NULL || strcmp(instantiationToken, INSTANTIATION_TOKEN) != 0) {
        fail(instance, "instantiation token does not belong to this FMU");
    } else if (eventModeUsed) {
        fail(instance, "event mode is not offered");
    } else if (nRequiredIntermediateVariables > 0) {
        fail(instance, "intermediate variables are not offered");
    } else {
        const size_t size = strlen(instanceName) + 1;
        instance->name = malloc(size);
        if (instance->name != NULL) {
            memcpy(instance->name, instanceName, size);
            set_defaults(instance);
            return instance;
        }
    }
    free(instance);
    return NULL;
}

void fmi3FreeInstance(fmi3Instance instance)
{
    if (instance != NULL) {
        free(((Instance *)instance)->name);
        free(instance);
    }
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean toleranceDefined,
                                       fmi3Float64 tolerance, fmi3Float64 startTime,
                                       fmi3Boolean stopTimeDefined, fmi3Float64 stopTime)
{
    Instance *const me = instance;
    (void)toleranceDefined, (void)tolerance;
    if (me->now.phase != INSTANTIATED) {
        return fail(me, "fmi3EnterInitializationMode: not directly after instantiation or reset");
    }
    if (!isfinite(startTime)) {
        return fail(me, "start time is not a finite number");
    }
    me->now.core.t = startTime;
    me->now.stop_time = stopTimeDefined ? stopTime : INFINITY;
    me->now.phase = INITIALIZING;
    return fmi3OK;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance instance)
{
    Instance *const me = instance;
    if (me->now.phase != INITIALIZING) {
        return fail(me, "fmi3ExitInitializationMode: not in initialization mode");
    }
    const fmi3Status status = tell(me, settle(&me->now.core, true));
    if (status == fmi3OK) {
        me->now.phase = STEPPING;
        me->now.inputs_changed = false;
    }
    return status;
}

fmi3Status fmi3Terminate(fmi3Instance instance)
{
    Instance *const me = instance;
    if (me->now.phase != STEPPING) {
        return fail(me, "fmi3Terminate: not in step mode");
    }
    me->now.phase = TERMINATED;
    return fmi3OK;
}

fmi3Status fmi3Reset(fmi3Instance instance)
{
    set_defaults(instance);
    return fmi3OK;
}

/* --- values ----------------------------------------------------------------------------- */

static const VariableInfo *find(const Instance *me, fmi3ValueReference reference, VariableType type)
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

/* Make y follow from what was set since the last step. */
static fmi3Status refresh(Instance *me)
{
    if (!me->now.inputs_changed) {
        return fmi3OK;
    }
    if (me->now.phase == INSTANTIATED || me->now.phase == INITIALIZING) {
        return tell(me, settle(&me->now.core, true)); /* more may be set before the start */
    }
    model_algebraics(me->now.core.t, me->now.core.y, me->now.core.p);
    return fmi3OK;
}

static double value_of(const Instance *me, const VariableInfo *variable)
{
    const Core *const core = &me->now.core;
    return variable->vector == IS_TIME ? core->t
         : variable->vector == IN_Y    ? core->y[variable->index]
                                       : core->p[variable->index];
}

static fmi3Status set_value(Instance *me, const VariableInfo *variable, double value)
{
    const bool before_start = me->now.phase == INSTANTIATED || me->now.phase == INITIALIZING;
    if (variable->class == CLASS_OUTPUT) {
        return fail(me, "%s cannot be set", variable->name);
    }
    if (variable->class == CLASS_PARAMETER && !before_start) {
        return fail(me, "%s can only be set before the start", variable->name);
    }
    if (!isfinite(value) || value < variable->min || value > variable->max) {
        return fail(me, "%s = %.12g is outside %.12g .. %.12g (t = %.12g s)", variable->name, value,
                    variable->min, variable->max, me->now.core.t);
    }
    me->now.core.p[variable->index] = value;
    me->now.inputs_changed = true;
    return fmi3OK;
}

#define GET(Name, Type, KIND, CONVERSION)                                                          \
    fmi3Status fmi3Get##Name(fmi3Instance instance, const fmi3ValueReference valueReferences[],    \
                             size_t nValueReferences, Type values[], size_t nValues)               \
    {                                                                                              \
        Instance *const me = instance;                                                             \
        if (nValues != nValueReferences) {                                                         \
            return fail(me, "every variable has exactly one value");                               \
        }                                                                                          \
        const fmi3Status status = refresh(me);                                                     \
        for (size_t i = 0; i < nValues; i++) {                                                     \
            const VariableInfo *const variable = find(me, valueReferences[i], KIND);               \
            if (variable == NULL) {                                                                \
                return fmi3Error;                                                                  \
            }                                                                                      \
            values[i] = CONVERSION value_of(me, variable);                                         \
        }                                                                                          \
        return status;                                                                             \
    }

#define SET(Name, Type, KIND)                                                                      \
    fmi3Status fmi3Set##Name(fmi3Instance instance, const fmi3ValueReference valueReferences[],    \
                             size_t nValueReferences, const Type values[], size_t nValues)         \
    {                                                                                              \
        Instance *const me = instance;                                                             \
        if (nValues != nValueReferences) {                                                         \
            return fail(me, "every variable has exactly one value");                               \
        }                                                                                          \
        for (size_t i = 0; i < nValues; i++) {                                                     \
            const VariableInfo *const variable = find(me, valueReferences[i], KIND);               \
            if (variable == NULL || set_value(me, variable, (double)values[i]) != fmi3OK) {        \
                return fmi3Error;                                                                  \
            }                                                                                      \
        }                                                                                          \
        return fmi3OK;                                                                             \
    }

GET(Float64, fmi3Float64, TYPE_FLOAT64, )
GET(Int32, fmi3Int32, TYPE_INT32, (fmi3Int32))
GET(Boolean, fmi3Boolean, TYPE_BOOLEAN, 0.0 !=)
SET(Float64, fmi3Float64, TYPE_FLOAT64)
SET(Int32, fmi3Int32, TYPE_INT32)
SET(Boolean, fmi3Boolean, TYPE_BOOLEAN)

/* --- steps ------------------------------------------------------------------------------ */

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 currentCommunicationPoint,
                      fmi3Float64 communicationStepSize,
                      fmi3Boolean noSetFMUStatePriorToCurrentPoint,
                      fmi3Boolean *eventHandlingNeeded, fmi3Boolean *terminateSimulation,
                      fmi3Boolean *earlyReturn, fmi3Float64 *lastSuccessfulTime)
{
    Instance *const me = instance;
    Core *const core = &me->now.core;
    (void)noSetFMUStatePriorToCurrentPoint;
    *eventHandlingNeeded = fmi3False;
    *terminateSimulation = fmi3False;
    *earlyReturn = fmi3False;
    *lastSuccessfulTime = core->t;
    if (me->now.phase != STEPPING) {
        return fail(me, "fmi3DoStep: not in step mode");
    }
    const double room = 1e-9 + 1e-12 * fabs(core->t);
    if (!(fabs(currentCommunicationPoint - core->t) <= room)) {
        return fail(me, "fmi3DoStep: at t = %.12g s, not %.12g s", core->t,
                    currentCommunicationPoint);
    }
    const double end = whole_ns(currentCommunicationPoint + communicationStepSize);
    if (!(communicationStepSize > 0.0) || !isfinite(end)) {
        return fail(me, "fmi3DoStep: step size %.12g s", communicationStepSize);
    }
    if (end > me->now.stop_time + room) {
        return fail(me, "fmi3DoStep: %.12g s lies behind the stop time", end);
    }
    if (me->now.inputs_changed || core->t != currentCommunicationPoint) {
        core->t = currentCommunicationPoint;
        const fmi3Status settled = tell(me, settle(core, false));
        if (settled != fmi3OK) {
            return settled;
        }
        me->now.inputs_changed = false;
    }
    const fmi3Status status = tell(me, advance(core, end));
    *lastSuccessfulTime = core->t;
    return status;
}

/* --- state of the FMU ------------------------------------------------------------------- */

fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState *FMUState)
{
    Instance *const me = instance;
    if (*FMUState == NULL) {
        *FMUState = malloc(sizeof(Saved));
        if (*FMUState == NULL) {
            return fail(me, "no memory for the state");
        }
    }
    memcpy(*FMUState, &me->now, sizeof(Saved));
    return fmi3OK;
}

fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState FMUState)
{
    Instance *const me = instance;
    if (FMUState == NULL) {
        return fail(me, "fmi3SetFMUState: no state");
    }
    memcpy(&me->now, FMUState, sizeof(Saved));
    return fmi3OK;
}

fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState *FMUState)
{
    (void)instance;
    if (FMUState != NULL) {
        free(*FMUState);
        *FMUState = NULL;
    }
    return fmi3OK;
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState FMUState, size_t *size)
{
    (void)instance, (void)FMUState;
    *size = sizeof SERIAL_MARK + sizeof(Saved);
    return fmi3OK;
}

fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState FMUState,
                                 fmi3Byte serializedState[], size_t size)
{
    if (FMUState == NULL || size != sizeof SERIAL_MARK + sizeof(Saved)) {
        return fail(instance, "fmi3SerializeFMUState: no state or wrong size");
    }
    memcpy(serializedState, SERIAL_MARK, sizeof SERIAL_MARK);
    memcpy(serializedState + sizeof SERIAL_MARK, FMUState, sizeof(Saved));
    return fmi3OK;
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte serializedState[],
                                   size_t size, fmi3FMUState *FMUState)
{
    if (size != sizeof SERIAL_MARK + sizeof(Saved) ||
        memcmp(serializedState, SERIAL_MARK, sizeof SERIAL_MARK) != 0) {
        return fail(instance, "fmi3DeserializeFMUState: the bytes are not a state of this FMU");
    }
    if (*FMUState == NULL) {
        *FMUState = malloc(sizeof(Saved));
        if (*FMUState == NULL) {
            return fail(instance, "no memory for the state");
        }
    }
    memcpy(*FMUState, serializedState + sizeof SERIAL_MARK, sizeof(Saved));
    return fmi3OK;
}

#include "fmi3_absent.c"
