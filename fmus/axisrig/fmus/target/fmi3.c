/* FMI 3.0 co-simulation: the names of that version for slave.c.
 *
 * Source: FMI specification 3.0.2, sections 2 and 4.
 */
#include "fmi3Functions.h"
#include "slave.c"

static void emit(const Instance *me, Status status, const char *category, const char *text)
{
    ((fmi3LogMessageCallback)me->log)(me->environment, (fmi3Status)status, category, text);
}

#define BEGIN                                                                                      \
    Instance *const me = instance;                                                                 \
    if (me == NULL) {                                                                              \
        return fmi3Error;                                                                          \
    }

/* --- life ------------------------------------------------------------------------------- */

const char *fmi3GetVersion(void) { return fmi3Version; }

fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean loggingOn, size_t nCategories,
                               const fmi3String categories[])
{
    BEGIN
    return (fmi3Status)choose_categories(me, loggingOn, nCategories, categories);
}

fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String instanceName, fmi3String instantiationToken, fmi3String resourcePath,
    fmi3Boolean visible, fmi3Boolean loggingOn, fmi3Boolean eventModeUsed,
    fmi3Boolean earlyReturnAllowed, const fmi3ValueReference requiredIntermediateVariables[],
    size_t nRequiredIntermediateVariables, fmi3InstanceEnvironment instanceEnvironment,
    fmi3LogMessageCallback logMessage, fmi3IntermediateUpdateCallback intermediateUpdate)
{
    (void)resourcePath, (void)visible, (void)loggingOn;
    (void)requiredIntermediateVariables, (void)intermediateUpdate;
    Instance *const me = new_instance(instanceName, instantiationToken, instanceEnvironment,
                                      (void (*)(void))logMessage);
    if (me != NULL && eventModeUsed) {
        fail(me, "event mode is not offered");
    } else if (me != NULL && nRequiredIntermediateVariables > 0) {
        fail(me, "intermediate variables are not offered");
    } else {
        if (me != NULL) {
            me->early_return_allowed = earlyReturnAllowed;
        }
        return me;
    }
    release(me);
    return NULL;
}

void fmi3FreeInstance(fmi3Instance instance) { release(instance); }

fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean toleranceDefined,
                                       fmi3Float64 tolerance, fmi3Float64 startTime,
                                       fmi3Boolean stopTimeDefined, fmi3Float64 stopTime)
{
    BEGIN
    (void)toleranceDefined, (void)tolerance;
    if (me->now.phase != INSTANTIATED) {
        return (fmi3Status)misplaced(me, "fmi3EnterInitializationMode");
    }
    const Status status = set_times(me, startTime, stopTimeDefined, stopTime);
    if (status == STATUS_OK) {
        me->now.phase = INITIALIZING;
    }
    return (fmi3Status)status;
}

/* A model that ends the simulation has flags of its own in the step; here the first step tells it. */
static fmi3Status without_end(Status status)
{
    return status == STATUS_DISCARD ? fmi3OK : (fmi3Status)status;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance instance)
{
    BEGIN
    if (me->now.phase != INITIALIZING) {
        return (fmi3Status)misplaced(me, "fmi3ExitInitializationMode");
    }
    return without_end(exit_initialization(me));
}

fmi3Status fmi3Terminate(fmi3Instance instance)
{
    BEGIN
    if (me->now.phase != STEPPING && me->now.phase != ENDED) {
        return (fmi3Status)misplaced(me, "fmi3Terminate");
    }
    me->now.phase = TERMINATED;
    return fmi3OK;
}

fmi3Status fmi3Reset(fmi3Instance instance)
{
    BEGIN
    set_defaults(me);
    return fmi3OK;
}

/* --- values ----------------------------------------------------------------------------- */

#define ACCESS(Name, Type, KIND, FROM_DOUBLE, TO_DOUBLE)                                           \
    VALUES(Name, Type, KIND, FROM_DOUBLE, TO_DOUBLE)                                               \
    fmi3Status fmi3Get##Name(fmi3Instance instance, const fmi3ValueReference valueReferences[],    \
                             size_t nValueReferences, Type values[], size_t nValues)               \
    {                                                                                              \
        BEGIN                                                                                      \
        return (fmi3Status)get_##Name(me, "fmi3Get" #Name, valueReferences, nValueReferences,      \
                                      values, nValues);                                            \
    }                                                                                              \
    fmi3Status fmi3Set##Name(fmi3Instance instance, const fmi3ValueReference valueReferences[],    \
                             size_t nValueReferences, const Type values[], size_t nValues)         \
    {                                                                                              \
        BEGIN                                                                                      \
        return (fmi3Status)set_##Name(me, "fmi3Set" #Name, valueReferences, nValueReferences,      \
                                      values, nValues);                                            \
    }

ACCESS(Float64, fmi3Float64, TYPE_FLOAT64, , )
ACCESS(Int32, fmi3Int32, TYPE_INT32, (fmi3Int32), )
ACCESS(Int64, fmi3Int64, TYPE_ENUMERATION, (fmi3Int64), (double))
ACCESS(Boolean, fmi3Boolean, TYPE_BOOLEAN, 0.0 !=, 0 !=)

/* --- steps ------------------------------------------------------------------------------ */

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 currentCommunicationPoint,
                      fmi3Float64 communicationStepSize,
                      fmi3Boolean noSetFMUStatePriorToCurrentPoint,
                      fmi3Boolean *eventHandlingNeeded, fmi3Boolean *terminateSimulation,
                      fmi3Boolean *earlyReturn, fmi3Float64 *lastSuccessfulTime)
{
    BEGIN
    (void)noSetFMUStatePriorToCurrentPoint;
    me->notes.may_return_early = me->early_return_allowed;
    me->notes.returned_early = false;
    const Status status = step(me, "fmi3DoStep", currentCommunicationPoint, communicationStepSize);
    me->notes.may_return_early = false;
    *eventHandlingNeeded = fmi3False;
    *terminateSimulation = status == STATUS_DISCARD;
    *earlyReturn = me->notes.returned_early && status <= STATUS_WARNING;
    *lastSuccessfulTime = me->now.core.t;
    return without_end(status);
}

/* --- state of the FMU ------------------------------------------------------------------- */

fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState *FMUState)
{
    BEGIN
    return (fmi3Status)save(me, FMUState);
}

fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState FMUState)
{
    BEGIN
    return (fmi3Status)restore(me, "fmi3SetFMUState", FMUState);
}

fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState *FMUState)
{
    (void)instance;
    release_state(FMUState);
    return fmi3OK;
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState FMUState, size_t *size)
{
    BEGIN
    *size = SERIAL_SIZE;
    return FMUState == NULL ? (fmi3Status)fail(me, "fmi3SerializedFMUStateSize: no state") : fmi3OK;
}

fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState FMUState,
                                 fmi3Byte serializedState[], size_t size)
{
    BEGIN
    return (fmi3Status)serialize(me, "fmi3SerializeFMUState", FMUState, serializedState, size);
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte serializedState[],
                                   size_t size, fmi3FMUState *FMUState)
{
    BEGIN
    return (fmi3Status)deserialize(me, "fmi3DeserializeFMUState", serializedState, size, FMUState);
}

#include "fmi3_absent.c"
