/* Functions of FMI 2.0 that a co-simulation FMU of this kind does not offer.
 *
 * Those of co-simulation must exist so that an importer can load the library; those of model
 * exchange are there so that a mistaken call is told.
 */
#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif

#define ABSENT(Name, ...)                                                                          \
    fmi2Status Name(fmi2Component c, __VA_ARGS__)                                                  \
    {                                                                                              \
        BEGIN                                                                                      \
        return (fmi2Status)fail(me, #Name " is not offered");                                      \
    }

#define ABSENT_BARE(Name)                                                                          \
    fmi2Status Name(fmi2Component c)                                                               \
    {                                                                                              \
        BEGIN                                                                                      \
        return (fmi2Status)fail(me, #Name " is not offered");                                      \
    }

ABSENT(fmi2GetString, const fmi2ValueReference vr[], size_t nvr, fmi2String value[])
ABSENT(fmi2SetString, const fmi2ValueReference vr[], size_t nvr, const fmi2String value[])
ABSENT(fmi2GetDirectionalDerivative, const fmi2ValueReference vUnknown_ref[], size_t nUnknown,
       const fmi2ValueReference vKnown_ref[], size_t nKnown, const fmi2Real dvKnown[],
       fmi2Real dvUnknown[])
ABSENT(fmi2SetRealInputDerivatives, const fmi2ValueReference vr[], size_t nvr,
       const fmi2Integer order[], const fmi2Real value[])
ABSENT(fmi2GetRealOutputDerivatives, const fmi2ValueReference vr[], size_t nvr,
       const fmi2Integer order[], fmi2Real value[])
ABSENT_BARE(fmi2CancelStep)
ABSENT_BARE(fmi2EnterEventMode)
ABSENT(fmi2NewDiscreteStates, fmi2EventInfo *fmi2eventInfo)
ABSENT_BARE(fmi2EnterContinuousTimeMode)
ABSENT(fmi2CompletedIntegratorStep, fmi2Boolean noSetFMUStatePriorToCurrentPoint,
       fmi2Boolean *enterEventMode, fmi2Boolean *terminateSimulation)
ABSENT(fmi2SetTime, fmi2Real time)
ABSENT(fmi2SetContinuousStates, const fmi2Real x[], size_t nx)
ABSENT(fmi2GetDerivatives, fmi2Real derivatives[], size_t nx)
ABSENT(fmi2GetEventIndicators, fmi2Real eventIndicators[], size_t ni)
ABSENT(fmi2GetContinuousStates, fmi2Real x[], size_t nx)
ABSENT(fmi2GetNominalsOfContinuousStates, fmi2Real x_nominal[], size_t nx)
