/* Four numbers that are computed together: a vector of the processor where FOURS_IN_VECTORS is defined, else lane after
   lane. What one of the four is comes out the same either way. Included anew for each of the two.

   Arrays of fours are arrays of numbers, four for each. EACH makes a number one that stands for four alike, FILL stores
   such a number, and SPREAD makes a four of one. EVERY_LANE calls what computes four, once or for each lane. FOR_FOURS
   goes through so many entries of arrays, four at least: the last four may be some once more. GIVEN, TURN and PASSED are
   the fours at a place of the arrays given, turns and passed. */
#undef FOUR
#undef EACH
#undef SPREAD
#undef LOAD
#undef STORE
#undef FILL
#undef EVERY_LANE
#undef FOR_FOURS
#undef GIVEN
#undef TURN
#undef PASSED

#define EACH(number) ((casadi_real)(number))
#define GIVEN(place) LOAD(given + (place))
#define TURN(place) LOAD(turns + (place))
#define PASSED(place) LOAD(passed + (place))

#ifdef FOURS_IN_VECTORS
/* Aligned as numbers are: any four neighbours in an array are fours. */
typedef casadi_real vector_of_four
    __attribute__((vector_size(4 * sizeof(casadi_real)), aligned(sizeof(casadi_real)), may_alias));

#define FOUR vector_of_four
#define SPREAD(number) (EACH(number) - (FOUR){0})
#define LOAD(numbers) (*(const FOUR *)(numbers))
#define STORE(numbers, value) (*(FOUR *)(numbers) = (value))
#define FILL(numbers, number) ((numbers)[0] = (numbers)[1] = (numbers)[2] = (numbers)[3] = (number))
#define EVERY_LANE(call) \
  {                      \
    enum { lane = 0 };   \
    call;                \
  }
#define FOR_FOURS(i, count) \
  for (int i = 0; i < (count); i += (count) % 4 == 0 || i + 8 <= (count) || i + 4 == (count) ? 4 : (count) - 4 - i)
#else
#define FOUR casadi_real
#define SPREAD(number) EACH(number)
#define LOAD(numbers) (*(numbers))
#define STORE(numbers, value) (*(numbers) = (value))
#define FILL(numbers, number) (*(numbers) = (number))
#define EVERY_LANE(call)                   \
  {                                        \
    int lane;                              \
    for (lane = 0; lane < 4; lane++) call; \
  }
#define FOR_FOURS(i, count) for (int i = 0; i < (count); i++)
#endif
