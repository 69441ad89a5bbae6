/* Four numbers that are computed together: a vector of the processor where the compiler has such, else one after the
   other. What one of the four is comes out the same either way.

   Arrays of fours are arrays of numbers, four for each. EACH makes a number one that stands for four alike. */
#ifndef FOURS_H
#define FOURS_H

#if defined(__GNUC__) && !defined(FOURS_ONE_BY_ONE)
/* Aligned as numbers are: any four neighbours in an array are fours. */
typedef casadi_real four __attribute__((vector_size(4 * sizeof(casadi_real)), aligned(sizeof(casadi_real)), may_alias));

#define EACH(number) ((casadi_real)(number))
#define LOAD(numbers) (*(const four *)(numbers))
#define STORE(numbers, value) (*(four *)(numbers) = (value))
#define ADD(a, b) ((a) + (b))
#define SUBTRACT(a, b) ((a) - (b))
#define MULTIPLY(a, b) ((a) * (b))
#define DIVIDE(a, b) ((a) / (b))

/* On x86 functions are made a second time for the wider vectors of newer processors, and chosen as the program runs,
   unless FOURS_ONCE asks for the shorter compilation. */
#if defined(__x86_64__) && !defined(__AVX2__) && !defined(FOURS_ONCE)
#define FOURS_TWICE
#endif

#else
typedef struct {
  casadi_real of[4];
} four;

#define EACH(number) four_alike(number)
#define LOAD(numbers) four_at(numbers)
#define STORE(numbers, value) four_into(numbers, value)
#define ADD(a, b) four_sum(a, b)
#define SUBTRACT(a, b) four_difference(a, b)
#define MULTIPLY(a, b) four_product(a, b)
#define DIVIDE(a, b) four_quotient(a, b)

static inline four four_alike(casadi_real number) {
  four made;
  int i;
  for (i = 0; i < 4; i++) made.of[i] = number;
  return made;
}

static inline four four_at(const casadi_real *numbers) {
  four made;
  int i;
  for (i = 0; i < 4; i++) made.of[i] = numbers[i];
  return made;
}

static inline void four_into(casadi_real *numbers, four value) {
  int i;
  for (i = 0; i < 4; i++) numbers[i] = value.of[i];
}

#define ONE_BY_ONE(name, operation)            \
  static inline four name(four a, four b) {    \
    int i;                                     \
    for (i = 0; i < 4; i++) a.of[i] operation b.of[i]; \
    return a;                                  \
  }
ONE_BY_ONE(four_sum, +=)
ONE_BY_ONE(four_difference, -=)
ONE_BY_ONE(four_product, *=)
ONE_BY_ONE(four_quotient, /=)
#endif
#endif
