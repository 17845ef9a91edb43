/* An ideal axis as an FMI 3.0 co-simulation FMU with one fault that it is given when compiled.
   CRASH_IN, CRASH_HOW, CRASH_AT_S: in which call it ends its process, how, from which time on.
   CRASH_FROM: the call itself, a thread that the call starts, or one that the call waits for.
   EXIT_CODE: of exit() and _exit().
   FLAW: what it does wrong without a crash. */
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>
#ifdef __x86_64__
#include <xmmintrin.h>
#endif

#include "fmi3Functions.h"

enum { NOWHERE, LOAD, INSTANTIATE, INITIALIZE, SET, GET, STEP, TERMINATE, FREE };
enum { SEGFAULT, ABORT, EXIT, QUIT, HANG, KILL };
enum { CALL, THREAD, AWAITED };
enum { NONE, GLOBAL, ADDRESS, COUNTS, FORGETS, FORGETS_BYTES, NAN_OUTPUT, CHDIR, FLUSH, REFUSES,
       STICKS, PRINTS, LIES, HOLDS, COUNTS_STEPS, WRITES, LOWERS };

#ifndef CRASH_IN
#define CRASH_IN NOWHERE
#endif
#ifndef CRASH_HOW
#define CRASH_HOW SEGFAULT
#endif
#ifndef CRASH_FROM
#define CRASH_FROM CALL
#endif
#ifndef EXIT_CODE
#define EXIT_CODE 3
#endif
#ifndef FLAW
#define FLAW NONE
#endif
#ifndef CRASH_AT_S
#define CRASH_AT_S 0.0
#endif

typedef struct {
  double time, position_start, reference[4], position, velocity, way;
  fmi3Boolean enabled;
} Axis;

static double everybodys_way; /* GLOBAL: shared by all instances */
static int instances;         /* COUNTS: tells the first from the second */

static void *die(void *unused) {
  switch (CRASH_HOW) {
    case SEGFAULT: *(volatile int *)8 = 1; break;
    case ABORT: abort();
    case EXIT: exit(EXIT_CODE);
    case QUIT: _exit(EXIT_CODE);
    case KILL: raise(SIGKILL); break;
    case HANG: for (;;) pause(); /* costs no CPU time, so that a test may wait long */
  }
  return unused;
}

static void here(int call, double time) {
  static int begun;
  if (call != CRASH_IN || time < CRASH_AT_S) return;
  if (CRASH_FROM == CALL) die(NULL);
  if (begun++) return; /* one thread is enough */
  pthread_t thread;
  if (pthread_create(&thread, NULL, die, NULL)) abort();
  if (CRASH_FROM == AWAITED && CRASH_HOW != HANG) pthread_join(thread, NULL);
}

__attribute__((constructor)) static void load(void) {
  here(LOAD, 1e9);
#ifdef __x86_64__
  if (FLAW == FLUSH) _mm_setcsr(_mm_getcsr() | 0x8040); /* what -ffast-math links in */
#endif
}

/* HOLDS: everything stands still inside a millisecond, as in a container that steps by itself.
   COUNTS_STEPS: what comes out depends on the number of steps. */
static void move(Axis *a, double step) {
  if (FLAW == HOLDS && floor(a->time * 1e3 + 1e-6) == floor((a->time - step) * 1e3 + 1e-6)) return;
  const double *r = a->reference; /* position, velocity, time, end */
  double end = a->time < r[3] ? a->time : r[3];
  if (a->enabled) a->position = r[0] + r[1] * (end - r[2]);
  a->velocity = a->enabled && a->time < r[3] ? r[1] : 0.0;
  double *way = FLAW == GLOBAL ? &everybodys_way : &a->way;
  *way += (1e-3 + a->position) * (FLAW == COUNTS_STEPS ? 1e-3 : step);
  if (FLAW == ADDRESS) *way = (double)((size_t)&everybodys_way >> 12);
  if (FLAW == COUNTS) *way = instances;
  if (FLAW == NAN_OUTPUT) *way = 0.0 / (a->time - a->time);
}

#define EXPORT __attribute__((visibility("default")))
#define UNUSED(x) (void)(x)

EXPORT const char *fmi3GetVersion(void) { return "3.0"; }

EXPORT fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String name, fmi3String token, fmi3String path, fmi3Boolean visible, fmi3Boolean logging,
    fmi3Boolean events, fmi3Boolean early, const fmi3ValueReference required[], size_t count,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3IntermediateUpdateCallback update) {
  UNUSED(name), UNUSED(token), UNUSED(path), UNUSED(visible), UNUSED(logging), UNUSED(events);
  UNUSED(early), UNUSED(required), UNUSED(count), UNUSED(environment), UNUSED(log), UNUSED(update);
  here(INSTANTIATE, 1e9);
  Axis *a = calloc(1, sizeof *a);
  a->position_start = 0.13;
  if (FLAW == LIES) printf("V.A.MESS.Z=1\n"); /* which the C library keeps for a while */
  everybodys_way = 0.0, instances++;
  return a;
}

EXPORT void fmi3FreeInstance(fmi3Instance c) {
  here(FREE, 1e9);
  free(c);
}

EXPORT fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean d, fmi3Float64 tolerance,
                                              fmi3Float64 start, fmi3Boolean e, fmi3Float64 stop) {
  UNUSED(d), UNUSED(tolerance), UNUSED(e), UNUSED(stop);
  ((Axis *)c)->time = start;
  return fmi3OK;
}

EXPORT fmi3Status fmi3ExitInitializationMode(fmi3Instance c) {
  here(INITIALIZE, 1e9);
  Axis *a = c;
  a->position = a->position_start;
  return fmi3OK;
}

EXPORT fmi3Status fmi3Terminate(fmi3Instance c) {
  UNUSED(c);
  here(TERMINATE, 1e9);
  return fmi3OK;
}

EXPORT fmi3Status fmi3Reset(fmi3Instance c) {
  if (FLAW == STICKS) return fmi3OK;
  memset(c, 0, sizeof(Axis));
  ((Axis *)c)->position_start = 0.13;
  return fmi3OK;
}

EXPORT fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference r[], size_t n,
                                 const fmi3Float64 v[], size_t count) {
  Axis *a = c;
  here(SET, a->time);
  UNUSED(count);
  for (size_t i = 0; i < n; i++) {
    if (r[i] == 1) a->position_start = v[i];
    else if (r[i] >= 2 && r[i] <= 5) a->reference[r[i] - 2] = v[i];
    else return fmi3Error;
  }
  return fmi3OK;
}

EXPORT fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference r[], size_t n,
                                 fmi3Float64 v[], size_t count) {
  Axis *a = c;
  here(GET, a->time);
  UNUSED(count);
  for (size_t i = 0; i < n; i++) {
    if (r[i] == 0) v[i] = a->time;
    else if (r[i] == 1) v[i] = a->position_start;
    else if (r[i] >= 2 && r[i] <= 5) v[i] = a->reference[r[i] - 2];
    else if (r[i] == 15) v[i] = FLAW == GLOBAL ? everybodys_way : a->way;
    else v[i] = r[i] % 2 ? a->velocity : a->position; /* 10, 12, 14 position, 11, 13 velocity */
  }
  return fmi3OK;
}

EXPORT fmi3Status fmi3SetBoolean(fmi3Instance c, const fmi3ValueReference r[], size_t n,
                                 const fmi3Boolean v[], size_t count) {
  UNUSED(r), UNUSED(count);
  if (n) ((Axis *)c)->enabled = v[n - 1];
  return fmi3OK;
}

EXPORT fmi3Status fmi3GetBoolean(fmi3Instance c, const fmi3ValueReference r[], size_t n,
                                 fmi3Boolean v[], size_t count) {
  UNUSED(r), UNUSED(count);
  for (size_t i = 0; i < n; i++) v[i] = ((Axis *)c)->enabled;
  return fmi3OK;
}

/* WRITES: into the sockets of its process, which are not its own */
static void write_everywhere(void) {
  struct stat state;
  for (int file = 3; file < 64; file++) {
    if (!fstat(file, &state) && S_ISSOCK(state.st_mode) && write(file, "axis", 4) != 4) return;
  }
}

/* LOWERS: the size that files of its process may have */
static void lower_limits(void) {
  struct rlimit limit = {1000, 1000};
  setrlimit(RLIMIT_FSIZE, &limit);
}

EXPORT fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 time, fmi3Float64 step, fmi3Boolean final,
                             fmi3Boolean *event, fmi3Boolean *terminate, fmi3Boolean *early,
                             fmi3Float64 *last) {
  Axis *a = c;
  here(STEP, time);
  UNUSED(final);
  if (FLAW == PRINTS && write(1, "a step\n", 7) != 7) return fmi3Fatal;
  if (FLAW == CHDIR && chdir("/")) return fmi3Fatal;
  if (FLAW == WRITES) write_everywhere();
  if (FLAW == LOWERS) lower_limits();
  if (FLAW == REFUSES && step < 5e-4) return fmi3Error;
  a->time = *last = time + step;
  *event = *terminate = *early = fmi3False;
  move(a, step);
  return fmi3OK;
}

EXPORT fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *state) {
  if (!*state) *state = malloc(sizeof(Axis));
  memcpy(*state, c, sizeof(Axis));
  return fmi3OK;
}

EXPORT fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState state) {
  double way = ((Axis *)c)->way;
  memcpy(c, state, sizeof(Axis));
  if (FLAW == FORGETS) ((Axis *)c)->way = way;
  return fmi3OK;
}

EXPORT fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *state) {
  UNUSED(c);
  free(*state);
  *state = NULL;
  return fmi3OK;
}

EXPORT fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, fmi3FMUState state, size_t *size) {
  UNUSED(c), UNUSED(state);
  *size = sizeof(Axis);
  return fmi3OK;
}

EXPORT fmi3Status fmi3SerializeFMUState(fmi3Instance c, fmi3FMUState state, fmi3Byte bytes[],
                                        size_t size) {
  UNUSED(c);
  memcpy(bytes, state, size);
  return fmi3OK;
}

#ifndef WITHOUT_DESERIALIZE
EXPORT fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const fmi3Byte bytes[], size_t size,
                                          fmi3FMUState *state) {
  if (fmi3GetFMUState(c, state) != fmi3OK) return fmi3Error;
  memcpy(*state, bytes, FLAW == FORGETS_BYTES ? size / 2 : size);
  return fmi3OK;
}
#endif
