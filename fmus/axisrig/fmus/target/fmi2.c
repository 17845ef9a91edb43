/* FMI 2.0 co-simulation: the names of that version for slave.c.
 *
 * Source: FMI specification 2.0.4, sections 2 and 4. What this kind of slave does not offer is an
 * error with a message.
 */
#include <string.h>

#include "fmi2Functions.h"
#include "slave.c"

/* The message is a format for the importer: its percent signs are doubled. */
static void emit(const Instance *me, Status status, const char *category, const char *text)
{
    char format[2 * MESSAGE_SIZE];
    char *end = format;
    for (const char *from = text; *from != '\0'; from++) {
        *end++ = *from;
        if (*from == '%') {
            *end++ = '%';
        }
    }
    *end = '\0';
    ((fmi2CallbackLogger)me->log)(me->environment, me->name == NULL ? "" : me->name,
                                  (fmi2Status)status, category, format);
}

#define BEGIN                                                                                      \
    Instance *const me = c;                                                                        \
    if (me == NULL) {                                                                              \
        return fmi2Error;                                                                          \
    }

/* --- life ------------------------------------------------------------------------------- */

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }

const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean loggingOn, size_t nCategories,
                               const fmi2String categories[])
{
    BEGIN
    return (fmi2Status)choose_categories(me, loggingOn, nCategories, categories);
}

fmi2Component fmi2Instantiate(fmi2String instanceName, fmi2Type fmuType, fmi2String fmuGUID,
                              fmi2String fmuResourceLocation,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible,
                              fmi2Boolean loggingOn)
{
    (void)fmuResourceLocation, (void)visible, (void)loggingOn;
    const bool has_functions = functions != NULL;
    Instance *const me =
        new_instance(instanceName, fmuGUID, has_functions ? functions->componentEnvironment : NULL,
                     has_functions ? (void (*)(void))functions->logger : NULL);
    if (me != NULL && fmuType != fmi2CoSimulation) {
        fail(me, "model exchange is not offered");
        release(me);
        return NULL;
    }
    return me;
}

void fmi2FreeInstance(fmi2Component c) { release(c); }

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance,
                               fmi2Real startTime, fmi2Boolean stopTimeDefined, fmi2Real stopTime)
{
    BEGIN
    (void)toleranceDefined, (void)tolerance;
    if (me->now.phase != INSTANTIATED) {
        return (fmi2Status)misplaced(me, "fmi2SetupExperiment");
    }
    return (fmi2Status)set_times(me, startTime, stopTimeDefined, stopTime);
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    BEGIN
    if (me->now.phase != INSTANTIATED) {
        return (fmi2Status)misplaced(me, "fmi2EnterInitializationMode");
    }
    me->now.phase = INITIALIZING;
    return fmi2OK;
}

/* terminate() at the start: the first step tells it. */
fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    BEGIN
    if (me->now.phase != INITIALIZING) {
        return (fmi2Status)misplaced(me, "fmi2ExitInitializationMode");
    }
    const Status status = exit_initialization(me);
    return status == STATUS_DISCARD ? fmi2OK : (fmi2Status)status;
}

fmi2Status fmi2Terminate(fmi2Component c)
{
    BEGIN
    if (me->now.phase != STEPPING && me->now.phase != ENDED) {
        return (fmi2Status)misplaced(me, "fmi2Terminate");
    }
    me->now.phase = TERMINATED;
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c)
{
    BEGIN
    set_defaults(me);
    return fmi2OK;
}

/* --- values ----------------------------------------------------------------------------- */

#define ACCESS(Name, Type, KIND, FROM_DOUBLE, TO_DOUBLE)                                           \
    VALUES(Name, Type, KIND, FROM_DOUBLE, TO_DOUBLE)                                               \
    fmi2Status fmi2Get##Name(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,           \
                             Type value[])                                                         \
    {                                                                                              \
        BEGIN                                                                                      \
        return (fmi2Status)get_##Name(me, "fmi2Get" #Name, vr, nvr, value, nvr);                   \
    }                                                                                              \
    fmi2Status fmi2Set##Name(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,           \
                             const Type value[])                                                   \
    {                                                                                              \
        BEGIN                                                                                      \
        return (fmi2Status)set_##Name(me, "fmi2Set" #Name, vr, nvr, value, nvr);                   \
    }

ACCESS(Real, fmi2Real, TYPE_FLOAT64, , )
ACCESS(Integer, fmi2Integer, TYPE_INT32, (fmi2Integer), )
ACCESS(Boolean, fmi2Boolean, TYPE_BOOLEAN, 0.0 !=, 0 !=)

/* --- steps ------------------------------------------------------------------------------ */

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real currentCommunicationPoint,
                      fmi2Real communicationStepSize, fmi2Boolean noSetFMUStatePriorToCurrentPoint)
{
    BEGIN
    (void)noSetFMUStatePriorToCurrentPoint;
    return (fmi2Status)step(me, "fmi2DoStep", currentCommunicationPoint, communicationStepSize);
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind s, fmi2Real *value)
{
    BEGIN
    if (s != fmi2LastSuccessfulTime) {
        return (fmi2Status)say(me, STATUS_DISCARD, "fmi2GetRealStatus: only LastSuccessfulTime");
    }
    *value = me->now.core.t;
    return fmi2OK;
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind s, fmi2Boolean *value)
{
    BEGIN
    if (s != fmi2Terminated) {
        return (fmi2Status)say(me, STATUS_DISCARD, "fmi2GetBooleanStatus: only Terminated");
    }
    *value = me->now.phase == ENDED;
    return fmi2OK;
}

/* No step is ever under way when a call returns. */
#define NEVER_PENDING(Name, Type)                                                                  \
    fmi2Status Name(fmi2Component c, const fmi2StatusKind s, Type *value)                          \
    {                                                                                              \
        BEGIN                                                                                      \
        (void)s, (void)value;                                                                      \
        return (fmi2Status)say(me, STATUS_DISCARD, #Name ": no step is pending");                  \
    }

NEVER_PENDING(fmi2GetStatus, fmi2Status)
NEVER_PENDING(fmi2GetIntegerStatus, fmi2Integer)
NEVER_PENDING(fmi2GetStringStatus, fmi2String)

/* --- state of the FMU ------------------------------------------------------------------- */

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *FMUstate)
{
    BEGIN
    return (fmi2Status)save(me, FMUstate);
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate FMUstate)
{
    BEGIN
    return (fmi2Status)restore(me, "fmi2SetFMUstate", FMUstate);
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *FMUstate)
{
    (void)c;
    release_state(FMUstate);
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate FMUstate, size_t *size)
{
    BEGIN
    *size = SERIAL_SIZE;
    return FMUstate == NULL ? (fmi2Status)fail(me, "fmi2SerializedFMUstateSize: no state") : fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate FMUstate, fmi2Byte serializedState[],
                                 size_t size)
{
    BEGIN
    return (fmi2Status)serialize(me, "fmi2SerializeFMUstate", FMUstate, serializedState, size);
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte serializedState[], size_t size,
                                   fmi2FMUstate *FMUstate)
{
    BEGIN
    return (fmi2Status)deserialize(me, "fmi2DeSerializeFMUstate", serializedState, size, FMUstate);
}

#include "fmi2_absent.c"
