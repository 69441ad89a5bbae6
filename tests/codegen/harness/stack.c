/* Measures the stack that the library's functions need, with -DBATCHES that of batches alone: each runs on a painted one.
   Prints bytes. */
#include "@{name}.h"

#include <pthread.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum { N = @{MACRO}_UNKNOWNS, INPUTS = @{MACRO}_INPUTS, ROOM = INPUTS + 1, STACK = 4 << 20, PAINT = 0xA5 };

static unsigned char stack[STACK] __attribute__((aligned(4096)));
static unsigned char *top;
static @{name}_workspace workspace;
static @{name}_memory memory;
static @{name}_real inputs[ROOM] = @{MACRO}_DEFAULTS, near[ROOM], x[N], d_x[N * ROOM], d_poses[@{MACRO}_POSES * 7 * ROOM];
static @{name}_real jacobian[N * N], residual[N];

static void solve(void) {
  @{name}_info info;
  @{name}_solve(inputs, x, &workspace, &info);
}

static void follow(void) {
  @{name}_real followed[N];
  memcpy(followed, x, sizeof followed);
  @{name}_follow(inputs, near, followed, &workspace, 0);
}

static void track(void) { @{name}_track(inputs, x, &memory, 0, d_x, d_poses, &workspace, 0); }

static void sensitivity(void) { @{name}_solve_sensitivity(inputs, x, d_x, d_poses, &workspace); }

static void equations(void) {
  @{name}_residual_jacobian(x, inputs, jacobian, residual, &workspace);
  @{name}_input_jacobian(x, inputs, d_x, &workspace);
}

static void results(void) {
  @{name}_results found;
  @{name}_evaluate(x, inputs, &found);
}

#ifdef BATCHES
enum { CASES = 16 };

static @{name}_real many[CASES * ROOM], solved[CASES * N];
static @{name}_batch_workspace batch_workspace;
static @{name}_info infos[CASES];

static void batch(void) {
  for (int i = 0; i < CASES * INPUTS; i++) many[i] = inputs[i % INPUTS];
  @{name}_solve_batch(CASES, many, solved, &batch_workspace, 1, infos);
}
#endif

static void *run(void *task) {
  volatile unsigned char mark = 1;
  top = (unsigned char *)(uintptr_t)&mark;
  (*(void (**)(void))task)();
  return 0;
}

static int bytes_of(void (*task)(void)) {
  pthread_attr_t attributes;
  pthread_t thread;
  int i = 0;
  memset(stack, PAINT, sizeof stack);
  pthread_attr_init(&attributes);
  if (pthread_attr_setstack(&attributes, stack, sizeof stack)) return -1;
  if (pthread_create(&thread, &attributes, run, &task)) return -1;
  pthread_join(thread, 0);
  while (stack[i] == PAINT) i++;
  return (int)(top - (stack + i));
}

int main(void) {
#ifdef BATCHES
  void (*const tasks[])(void) = {batch};
#else
  void (*const tasks[])(void) = {solve, follow, track, sensitivity, equations, results};
#endif
  const int count = (int)(sizeof tasks / sizeof *tasks);
  int most = 0;
  for (int i = 0; i < INPUTS; i++) near[i] = (@{name}_real)1.1 * inputs[i];
  for (int i = 0; i < count; i++) {
    const int bytes = bytes_of(tasks[i]);
    if (bytes < 0) return 1;
    fprintf(stderr, "%d ", bytes);
    if (bytes > most) most = bytes;
  }
  printf("%d %d\n", most, (int)@{MACRO}_WORKSPACE_SIZE);
  return 0;
}
