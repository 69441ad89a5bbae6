/* Modes that are blind to waves along elements that loads roll up: cosserat_casadi/equilibrium/blindness.py in C. */
typedef struct {
  int elements, unknowns, missing;
  const int *of_unknown;  /* element that each unknown turns, or -1 */
  const real *by_unknown; /* turn of the element by a unit of the unknown, rad */
  const real *unloaded;   /* turn of each unloaded element, rad */
  const int *of_missing;  /* element of each missing coordinate, or -1 */
  const int *modes;       /* number of modes of its strain in the richer model */
} turned_elements;

/* Whether an element turns so far that missing modes, which are not empty, do not see waves along it. times is its
   length over that in the table. Its turn is at most the unloaded turn plus the root mean square of the turn that loads
   add. */
static int hides_waves(const turned_elements *own, int element, real times, const real *x, const real *missing) {
  real square = 0, unseen = 0;
  for (int i = 0; i < own->unknowns; i++) {
    const real turned = own->of_unknown[i] == element ? own->by_unknown[i] * x[i] : 0;
    square += turned * turned;
  }
  const real turn = times * own->unloaded[element] + (real)sqrt(square);
  if (!(turn > ERROR_WHOLE_TURN)) return 0;
  for (int i = 0; i < own->missing; i++) {
    const int is_blind = own->of_missing[i] == element && (real)own->modes[i] < turn / 2 + (real)ERROR_BEYOND_TURN;
    unseen += is_blind ? missing[i] * missing[i] : 0;
  }
  return !((real)sqrt(unseen) <= ERROR_UNSEEN);
}
