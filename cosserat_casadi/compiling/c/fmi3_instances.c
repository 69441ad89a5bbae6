/* Instances of an FMU. */

static void reset(instance *self) {
  memset(&self->held, 0, sizeof self->held);
  memcpy(self->held.given, DEFAULT_INPUTS, sizeof DEFAULT_INPUTS);
  memcpy(self->held.parameters, DEFAULT_PARAMETERS, sizeof DEFAULT_PARAMETERS);
  self->held.step = FMU_STEP;
  self->held.mode = INSTANTIATED;
}

FMI3_EXPORT const char *fmi3GetVersion(void) { return "3.0"; }

FMI3_EXPORT fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
    fmi3Boolean event_mode_used, fmi3Boolean early_return_allowed, const fmi3ValueReference intermediate[],
    size_t intermediate_count, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3IntermediateUpdateCallback update) {
  (void)name, (void)resources, (void)visible, (void)event_mode_used, (void)early_return_allowed;
  (void)intermediate, (void)intermediate_count, (void)update;
  if (!token || strcmp(token, FMU_TOKEN) != 0) {
    if (log) log(environment, fmi3Error, "logStatusError", "the token is that of another model description");
    return 0;
  }
  instance *self = (instance *)calloc(1, sizeof *self);
  if (!self) {
    if (log) log(environment, fmi3Error, "logStatusError", "there is no memory for an instance");
    return 0;
  }
  self->environment = environment;
  self->log = log;
  self->logging = logging;
  reset(self);
  return self;
}

FMI3_EXPORT fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources,
                                                      fmi3Boolean visible, fmi3Boolean logging,
                                                      fmi3InstanceEnvironment environment, fmi3LogMessageCallback log) {
  (void)name, (void)token, (void)resources, (void)visible, (void)logging;
  if (log) log(environment, fmi3Error, "logStatusError", "this FMU is one for co-simulation alone");
  return 0;
}

FMI3_EXPORT fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources,
                                                           fmi3Boolean visible, fmi3Boolean logging,
                                                           fmi3InstanceEnvironment environment,
                                                           fmi3LogMessageCallback log, void (*clock)(void *),
                                                           void (*lock)(void), void (*unlock)(void)) {
  (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)clock, (void)lock, (void)unlock;
  if (log) log(environment, fmi3Error, "logStatusError", "this FMU is one for co-simulation alone");
  return 0;
}

FMI3_EXPORT void fmi3FreeInstance(fmi3Instance handle) { free(handle); }

FMI3_EXPORT fmi3Status fmi3SetDebugLogging(fmi3Instance handle, fmi3Boolean logging, size_t count,
                                           const fmi3String categories[]) {
  (void)count, (void)categories;
  ((instance *)handle)->logging = logging;
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3Reset(fmi3Instance handle) {
  reset((instance *)handle);
  return fmi3OK;
}
