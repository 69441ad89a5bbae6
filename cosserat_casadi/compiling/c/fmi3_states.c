/* Copies of the state of an instance. */

FMI3_EXPORT fmi3Status fmi3GetFMUState(fmi3Instance handle, fmi3FMUState *state) {
  instance *self = (instance *)handle;
  if (!*state) *state = malloc(sizeof self->held);
  if (!*state) return refuse(self, "fmi3GetFMUState", "there is no memory");
  memcpy(*state, &self->held, sizeof self->held);
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3SetFMUState(fmi3Instance handle, fmi3FMUState state) {
  instance *self = (instance *)handle;
  memcpy(&self->held, state, sizeof self->held);
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3FreeFMUState(fmi3Instance handle, fmi3FMUState *state) {
  (void)handle;
  free(*state);
  *state = 0;
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3SerializedFMUStateSize(fmi3Instance handle, fmi3FMUState state, size_t *size) {
  (void)handle, (void)state;
  *size = sizeof(snapshot);
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3SerializeFMUState(fmi3Instance handle, fmi3FMUState state, fmi3Byte bytes[], size_t size) {
  if (size < sizeof(snapshot)) return refuse((instance *)handle, "fmi3SerializeFMUState", "there is too little room");
  memcpy(bytes, state, sizeof(snapshot));
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3DeserializeFMUState(fmi3Instance handle, const fmi3Byte bytes[], size_t size,
                                               fmi3FMUState *state) {
  instance *self = (instance *)handle;
  if (size != sizeof(snapshot)) return refuse(self, "fmi3DeserializeFMUState", "not a state of this FMU");
  if (!*state) *state = malloc(sizeof(snapshot));
  if (!*state) return refuse(self, "fmi3DeserializeFMUState", "there is no memory");
  memcpy(*state, bytes, size);
  return fmi3OK;
}
