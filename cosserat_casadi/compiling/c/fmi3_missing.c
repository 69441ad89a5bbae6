/* Functions that this FMU does not offer: variables of other types, and functions of other kinds of FMU. */

/* The FMU has no variables of other types. */
#define NO_GETTER(Type)                                                                                        \
  FMI3_EXPORT fmi3Status fmi3Get##Type(fmi3Instance handle, const fmi3ValueReference references[], size_t count, \
                                       fmi3##Type values[], size_t value_count) {                              \
    (void)references, (void)values, (void)value_count;                                                         \
    return count == 0 ? fmi3OK : refuse((instance *)handle, "fmi3Get" #Type, "no such variable");              \
  }
#define NO_SETTER(Type)                                                                                        \
  FMI3_EXPORT fmi3Status fmi3Set##Type(fmi3Instance handle, const fmi3ValueReference references[], size_t count, \
                                       const fmi3##Type values[], size_t value_count) {                        \
    (void)references, (void)values, (void)value_count;                                                         \
    return count == 0 ? fmi3OK : refuse((instance *)handle, "fmi3Set" #Type, "no such variable");              \
  }
#define NO_VARIABLES(Type) NO_GETTER(Type) NO_SETTER(Type)
NO_VARIABLES(Float32)
NO_VARIABLES(Int8)
NO_VARIABLES(UInt8)
NO_VARIABLES(Int16)
NO_VARIABLES(UInt16)
NO_VARIABLES(Int32)
NO_VARIABLES(UInt32)
NO_VARIABLES(Int64)
NO_VARIABLES(UInt64)
NO_VARIABLES(Boolean)
NO_VARIABLES(String)

FMI3_EXPORT fmi3Status fmi3GetBinary(fmi3Instance handle, const fmi3ValueReference references[], size_t count,
                                     size_t sizes[], fmi3Binary values[], size_t value_count) {
  (void)references, (void)sizes, (void)values, (void)value_count;
  return count == 0 ? fmi3OK : refuse((instance *)handle, "fmi3GetBinary", "no such variable");
}

FMI3_EXPORT fmi3Status fmi3SetBinary(fmi3Instance handle, const fmi3ValueReference references[], size_t count,
                                     const size_t sizes[], const fmi3Binary values[], size_t value_count) {
  (void)references, (void)sizes, (void)values, (void)value_count;
  return count == 0 ? fmi3OK : refuse((instance *)handle, "fmi3SetBinary", "no such variable");
}

FMI3_EXPORT fmi3Status fmi3GetClock(fmi3Instance handle, const fmi3ValueReference references[], size_t count,
                                    fmi3Clock values[]) {
  (void)references, (void)values;
  return count == 0 ? fmi3OK : refuse((instance *)handle, "fmi3GetClock", "no such variable");
}

FMI3_EXPORT fmi3Status fmi3SetClock(fmi3Instance handle, const fmi3ValueReference references[], size_t count,
                                    const fmi3Clock values[]) {
  (void)references, (void)values;
  return count == 0 ? fmi3OK : refuse((instance *)handle, "fmi3SetClock", "no such variable");
}

#define NOT_OFFERED(function, ...)                                                      \
  FMI3_EXPORT fmi3Status function(fmi3Instance handle, __VA_ARGS__) {                   \
    return refuse((instance *)handle, #function, "is not offered by this FMU");         \
  }
#define NOT_OFFERED_ALONE(function)                                                     \
  FMI3_EXPORT fmi3Status function(fmi3Instance handle) {                                \
    return refuse((instance *)handle, #function, "is not offered by this FMU");         \
  }

#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif
typedef const fmi3ValueReference *references_in;
NOT_OFFERED(fmi3GetAdjointDerivative, references_in unknowns, size_t unknown_count, references_in knowns,
            size_t known_count, const fmi3Float64 *seed, size_t seed_count, fmi3Float64 *sensitivity, size_t count)
NOT_OFFERED(fmi3GetNumberOfVariableDependencies, fmi3ValueReference reference, size_t *count)
NOT_OFFERED(fmi3GetVariableDependencies, fmi3ValueReference dependent, size_t *dependent_elements,
            fmi3ValueReference *independents, size_t *independent_elements, fmi3DependencyKind *kinds, size_t count)
NOT_OFFERED_ALONE(fmi3EnterConfigurationMode)
NOT_OFFERED_ALONE(fmi3ExitConfigurationMode)
NOT_OFFERED_ALONE(fmi3EnterEventMode)
NOT_OFFERED_ALONE(fmi3EnterStepMode)
NOT_OFFERED_ALONE(fmi3EnterContinuousTimeMode)
NOT_OFFERED_ALONE(fmi3EvaluateDiscreteStates)
NOT_OFFERED(fmi3UpdateDiscreteStates, fmi3Boolean *update_needed, fmi3Boolean *terminate, fmi3Boolean *nominals_changed,
            fmi3Boolean *values_changed, fmi3Boolean *next_defined, fmi3Float64 *next_time)
NOT_OFFERED(fmi3GetIntervalDecimal, references_in references, size_t count, fmi3Float64 *intervals,
            fmi3IntervalQualifier *qualifiers)
NOT_OFFERED(fmi3GetIntervalFraction, references_in references, size_t count, fmi3UInt64 *counters,
            fmi3UInt64 *resolutions, fmi3IntervalQualifier *qualifiers)
NOT_OFFERED(fmi3GetShiftDecimal, references_in references, size_t count, fmi3Float64 *shifts)
NOT_OFFERED(fmi3GetShiftFraction, references_in references, size_t count, fmi3UInt64 *counters, fmi3UInt64 *resolutions)
NOT_OFFERED(fmi3SetIntervalDecimal, references_in references, size_t count, const fmi3Float64 *intervals)
NOT_OFFERED(fmi3SetIntervalFraction, references_in references, size_t count, const fmi3UInt64 *counters,
            const fmi3UInt64 *resolutions)
NOT_OFFERED(fmi3SetShiftDecimal, references_in references, size_t count, const fmi3Float64 *shifts)
NOT_OFFERED(fmi3SetShiftFraction, references_in references, size_t count, const fmi3UInt64 *counters,
            const fmi3UInt64 *resolutions)
NOT_OFFERED(fmi3CompletedIntegratorStep, fmi3Boolean no_set_prior, fmi3Boolean *event_mode, fmi3Boolean *terminate)
NOT_OFFERED(fmi3SetTime, fmi3Float64 time)
NOT_OFFERED(fmi3SetContinuousStates, const fmi3Float64 *states, size_t count)
NOT_OFFERED(fmi3GetContinuousStates, fmi3Float64 *states, size_t count)
NOT_OFFERED(fmi3GetContinuousStateDerivatives, fmi3Float64 *derivatives, size_t count)
NOT_OFFERED(fmi3GetEventIndicators, fmi3Float64 *indicators, size_t count)
NOT_OFFERED(fmi3GetNominalsOfContinuousStates, fmi3Float64 *nominals, size_t count)
NOT_OFFERED(fmi3GetNumberOfEventIndicators, size_t *count)
NOT_OFFERED(fmi3GetNumberOfContinuousStates, size_t *count)
NOT_OFFERED(fmi3GetOutputDerivatives, references_in references, size_t count, const fmi3Int32 *orders,
            fmi3Float64 *values, size_t value_count)
NOT_OFFERED(fmi3ActivateModelPartition, fmi3ValueReference clock, fmi3Float64 time)
