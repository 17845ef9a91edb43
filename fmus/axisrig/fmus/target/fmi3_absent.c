/* Functions of FMI 3.0 that a co-simulation FMU of this kind does not offer.
 *
 * They must exist so that an importer can load the library; each call is an error with a message.
 */
#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif

#define REFERENCES \
    fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences

#define ABSENT(Name, ...)                                                                          \
    fmi3Status Name(__VA_ARGS__)                                                                   \
    {                                                                                              \
        BEGIN                                                                                      \
        return (fmi3Status)fail(me, #Name " is not offered");                                      \
    }

fmi3Instance fmi3InstantiateModelExchange(fmi3String instanceName, fmi3String instantiationToken,
    fmi3String resourcePath, fmi3Boolean visible, fmi3Boolean loggingOn,
    fmi3InstanceEnvironment instanceEnvironment, fmi3LogMessageCallback logMessage)
{
    return NULL;
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String instanceName,
    fmi3String instantiationToken, fmi3String resourcePath, fmi3Boolean visible,
    fmi3Boolean loggingOn, fmi3InstanceEnvironment instanceEnvironment,
    fmi3LogMessageCallback logMessage, fmi3ClockUpdateCallback clockUpdate,
    fmi3LockPreemptionCallback lockPreemption, fmi3UnlockPreemptionCallback unlockPreemption)
{
    return NULL;
}

ABSENT(fmi3EnterEventMode, fmi3Instance instance)
ABSENT(fmi3GetFloat32, REFERENCES, fmi3Float32 values[], size_t nValues)
ABSENT(fmi3GetInt8, REFERENCES, fmi3Int8 values[], size_t nValues)
ABSENT(fmi3GetUInt8, REFERENCES, fmi3UInt8 values[], size_t nValues)
ABSENT(fmi3GetInt16, REFERENCES, fmi3Int16 values[], size_t nValues)
ABSENT(fmi3GetUInt16, REFERENCES, fmi3UInt16 values[], size_t nValues)
ABSENT(fmi3GetUInt32, REFERENCES, fmi3UInt32 values[], size_t nValues)
ABSENT(fmi3GetUInt64, REFERENCES, fmi3UInt64 values[], size_t nValues)
ABSENT(fmi3GetString, REFERENCES, fmi3String values[], size_t nValues)
ABSENT(fmi3GetBinary, REFERENCES, size_t valueSizes[], fmi3Binary values[], size_t nValues)
ABSENT(fmi3GetClock, REFERENCES, fmi3Clock values[])
ABSENT(fmi3SetFloat32, REFERENCES, const fmi3Float32 values[], size_t nValues)
ABSENT(fmi3SetInt8, REFERENCES, const fmi3Int8 values[], size_t nValues)
ABSENT(fmi3SetUInt8, REFERENCES, const fmi3UInt8 values[], size_t nValues)
ABSENT(fmi3SetInt16, REFERENCES, const fmi3Int16 values[], size_t nValues)
ABSENT(fmi3SetUInt16, REFERENCES, const fmi3UInt16 values[], size_t nValues)
ABSENT(fmi3SetUInt32, REFERENCES, const fmi3UInt32 values[], size_t nValues)
ABSENT(fmi3SetUInt64, REFERENCES, const fmi3UInt64 values[], size_t nValues)
ABSENT(fmi3SetString, REFERENCES, const fmi3String values[], size_t nValues)
ABSENT(fmi3SetBinary, REFERENCES, const size_t valueSizes[], const fmi3Binary values[],
       size_t nValues)
ABSENT(fmi3SetClock, REFERENCES, const fmi3Clock values[])
ABSENT(fmi3GetNumberOfVariableDependencies, fmi3Instance instance,
       fmi3ValueReference valueReference, size_t* nDependencies)
ABSENT(fmi3GetVariableDependencies, fmi3Instance instance, fmi3ValueReference dependent,
       size_t elementIndicesOfDependent[], fmi3ValueReference independents[],
       size_t elementIndicesOfIndependents[], fmi3DependencyKind dependencyKinds[],
       size_t nDependencies)
ABSENT(fmi3GetDirectionalDerivative, fmi3Instance instance, const fmi3ValueReference unknowns[],
       size_t nUnknowns, const fmi3ValueReference knowns[], size_t nKnowns,
       const fmi3Float64 seed[], size_t nSeed, fmi3Float64 sensitivity[], size_t nSensitivity)
ABSENT(fmi3GetAdjointDerivative, fmi3Instance instance, const fmi3ValueReference unknowns[],
       size_t nUnknowns, const fmi3ValueReference knowns[], size_t nKnowns,
       const fmi3Float64 seed[], size_t nSeed, fmi3Float64 sensitivity[], size_t nSensitivity)
ABSENT(fmi3EnterConfigurationMode, fmi3Instance instance)
ABSENT(fmi3ExitConfigurationMode, fmi3Instance instance)
ABSENT(fmi3GetIntervalDecimal, REFERENCES, fmi3Float64 intervals[],
       fmi3IntervalQualifier qualifiers[])
ABSENT(fmi3GetIntervalFraction, REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[],
       fmi3IntervalQualifier qualifiers[])
ABSENT(fmi3GetShiftDecimal, REFERENCES, fmi3Float64 shifts[])
ABSENT(fmi3GetShiftFraction, REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[])
ABSENT(fmi3SetIntervalDecimal, REFERENCES, const fmi3Float64 intervals[])
ABSENT(fmi3SetIntervalFraction, REFERENCES, const fmi3UInt64 counters[],
       const fmi3UInt64 resolutions[])
ABSENT(fmi3SetShiftDecimal, REFERENCES, const fmi3Float64 shifts[])
ABSENT(fmi3SetShiftFraction, REFERENCES, const fmi3UInt64 counters[],
       const fmi3UInt64 resolutions[])
ABSENT(fmi3EvaluateDiscreteStates, fmi3Instance instance)
ABSENT(fmi3UpdateDiscreteStates, fmi3Instance instance, fmi3Boolean* discreteStatesNeedUpdate,
       fmi3Boolean* terminateSimulation, fmi3Boolean* nominalsOfContinuousStatesChanged,
       fmi3Boolean* valuesOfContinuousStatesChanged, fmi3Boolean* nextEventTimeDefined,
       fmi3Float64* nextEventTime)
ABSENT(fmi3EnterContinuousTimeMode, fmi3Instance instance)
ABSENT(fmi3CompletedIntegratorStep, fmi3Instance instance,
       fmi3Boolean noSetFMUStatePriorToCurrentPoint, fmi3Boolean* enterEventMode,
       fmi3Boolean* terminateSimulation)
ABSENT(fmi3SetTime, fmi3Instance instance, fmi3Float64 time)
ABSENT(fmi3SetContinuousStates, fmi3Instance instance, const fmi3Float64 continuousStates[],
       size_t nContinuousStates)
ABSENT(fmi3GetContinuousStateDerivatives, fmi3Instance instance, fmi3Float64 derivatives[],
       size_t nContinuousStates)
ABSENT(fmi3GetEventIndicators, fmi3Instance instance, fmi3Float64 eventIndicators[],
       size_t nEventIndicators)
ABSENT(fmi3GetContinuousStates, fmi3Instance instance, fmi3Float64 continuousStates[],
       size_t nContinuousStates)
ABSENT(fmi3GetNominalsOfContinuousStates, fmi3Instance instance, fmi3Float64 nominals[],
       size_t nContinuousStates)
ABSENT(fmi3GetNumberOfEventIndicators, fmi3Instance instance, size_t* nEventIndicators)
ABSENT(fmi3GetNumberOfContinuousStates, fmi3Instance instance, size_t* nContinuousStates)
ABSENT(fmi3EnterStepMode, fmi3Instance instance)
ABSENT(fmi3GetOutputDerivatives, REFERENCES, const fmi3Int32 orders[], fmi3Float64 values[],
       size_t nValues)
ABSENT(fmi3ActivateModelPartition, fmi3Instance instance, fmi3ValueReference clockReference,
       fmi3Float64 activationTime)
