/* A co-simulation FMU that misbehaves as its parameter `behaviour` says; -DFMI=2 or -DFMI=3.

   x (mm) is the integral of u (mm/s), level is x > limit; both exact, for u is constant in a step. */

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { X = 0, U, LIMIT, SCALE, TEMPERATURE, REALS };
enum { BEHAVIOUR = REALS, LEVEL, VARIABLES };
enum {
    PLAIN,
    DISCARDS_LONG_STEPS,   /* above 0.3 ms: nothing is done */
    DISCARDS_HALF_WAY,     /* above 0.3 ms: half of it is done */
    DISCARDS_ALL,
    TELLS_NO_PROGRESS,     /* discards and does not say how far it came */
    ENDS,                  /* asks for the end at 5 ms */
    FAILS,                 /* error at 5 ms */
    WARNS,
    RETURNS_EARLY,         /* FMI 3: at the instant at which the level changes */
    RETURNS_AT_ONCE,       /* FMI 3: again and again without progress */
    CRASHES,
    NOT_A_NUMBER
};
enum { OK, WARNING, DISCARD, ERROR };

typedef struct {
    double real[REALS];
    int32_t behaviour;
    double time, last;
    bool ended, early_allowed;
    const char *name;
    void *environment;
    void *logger;
} Odd;

#if FMI == 2
typedef void (*Logger)(void *, const char *, int, const char *, const char *, ...);
typedef struct {
    Logger logger;
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void *finished;
    void *environment;
} Callbacks;
static void say(Odd *odd, int status, const char *text) {
    ((Logger)odd->logger)(odd->environment, odd->name, status, "trouble", "%s at %d ms", text,
                          (int)lround(odd->time * 1e3));
}
#else
typedef void (*Logger)(void *, int, const char *, const char *);
static void say(Odd *odd, int status, const char *text) {
    if (odd->logger) ((Logger)odd->logger)(odd->environment, status, "trouble", text);
}
#endif

static bool level(const Odd *odd) { return odd->real[X] > odd->real[LIMIT]; }

static void move(Odd *odd, double step) {
    odd->real[X] += odd->real[U] * step;
    odd->time += step;
    odd->last = odd->time;
}

/* One step; *early is set when it ends before its end with status ok. */
static int step(Odd *odd, double begin, double size, bool *early) {
    const bool is_long = size > 0.3e-3 * (1 + 1e-9);
    if (fabs(begin - odd->time) > 1e-9) {
        say(odd, ERROR, "asked for another time than mine");
        return ERROR;
    }
    odd->last = odd->time;
    switch (odd->behaviour) {
    case DISCARDS_LONG_STEPS:
        if (is_long) return DISCARD;
        break;
    case DISCARDS_HALF_WAY:
        if (is_long) {
            move(odd, size / 2);
            return DISCARD;
        }
        break;
    case DISCARDS_ALL:
        return DISCARD;
    case TELLS_NO_PROGRESS:
        odd->last = NAN;
        return DISCARD;
    case ENDS:
        if (odd->time + size > 5e-3) {
            odd->ended = true;
            return FMI == 2 ? DISCARD : OK;
        }
        break;
    case FAILS:
        if (odd->time + size > 5e-3) {
            say(odd, ERROR, "the spring is broken");
            return ERROR;
        }
        break;
    case WARNS:
        say(odd, WARNING, "hot");
        move(odd, size);
        return WARNING;
    case RETURNS_EARLY: {
        const double to_go = (odd->real[LIMIT] - odd->real[X]) / odd->real[U];
        if (odd->early_allowed && to_go > 1e-9 && to_go < size) {
            move(odd, to_go);
            odd->real[X] = nextafter(odd->real[LIMIT], INFINITY);
            *early = true;
            return OK;
        }
        break;
    }
    case RETURNS_AT_ONCE:
        *early = true;
        return OK;
    case CRASHES:
        abort();
    case NOT_A_NUMBER:
        move(odd, size);
        odd->real[X] = NAN;
        return OK;
    }
    move(odd, size);
    return OK;
}

static int get_reals(Odd *odd, const uint32_t *r, size_t n, double *value) {
    for (size_t i = 0; i < n; i++) value[i] = odd->real[r[i]];
    return OK;
}
static int set_reals(Odd *odd, const uint32_t *r, size_t n, const double *value) {
    for (size_t i = 0; i < n; i++) odd->real[r[i]] = value[i];
    return OK;
}
static Odd *create(const char *name, void *logger, void *environment) {
    Odd *odd = calloc(1, sizeof(Odd));
    odd->real[LIMIT] = 1.0;
    odd->real[SCALE] = 1.0;
    odd->name = name;
    odd->logger = logger;
    odd->environment = environment;
    return odd;
}
static int save(Odd *odd, void **state) {
    if (!*state) *state = malloc(sizeof(Odd));
    memcpy(*state, odd, sizeof(Odd));
    return OK;
}
static int restore(Odd *odd, void *state) {
    memcpy(odd, state, sizeof(Odd));
    return OK;
}
static int drop(void **state) {
    free(*state);
    *state = NULL;
    return OK;
}

#define API __attribute__((visibility("default")))

#if FMI == 2
API void *fmi2Instantiate(const char *name, int kind, const char *guid, const char *resources,
                          const Callbacks *callbacks, int visible, int logging) {
    (void)kind, (void)guid, (void)resources, (void)visible, (void)logging;
    return create(name, (void *)callbacks->logger, callbacks->environment);
}
API void fmi2FreeInstance(void *c) { free(c); }
API int fmi2SetDebugLogging(void *c, int on, size_t n, const char *const *words) {
    (void)c, (void)on, (void)n, (void)words;
    return OK;
}
API int fmi2SetupExperiment(Odd *c, int t, double tolerance, double start, int s, double stop) {
    (void)t, (void)tolerance, (void)s, (void)stop;
    c->time = c->last = start;
    return OK;
}
API int fmi2EnterInitializationMode(void *c) { (void)c; return OK; }
API int fmi2ExitInitializationMode(void *c) { (void)c; return OK; }
API int fmi2Terminate(void *c) { (void)c; return OK; }
API int fmi2GetReal(Odd *c, const uint32_t *r, size_t n, double *v) { return get_reals(c, r, n, v); }
API int fmi2SetReal(Odd *c, const uint32_t *r, size_t n, const double *v) { return set_reals(c, r, n, v); }
API int fmi2GetInteger(Odd *c, const uint32_t *r, size_t n, int32_t *v) {
    (void)r;
    for (size_t i = 0; i < n; i++) v[i] = c->behaviour;
    return OK;
}
API int fmi2SetInteger(Odd *c, const uint32_t *r, size_t n, const int32_t *v) {
    (void)r;
    for (size_t i = 0; i < n; i++) c->behaviour = v[i];
    return OK;
}
API int fmi2GetBoolean(Odd *c, const uint32_t *r, size_t n, int *v) {
    (void)r;
    for (size_t i = 0; i < n; i++) v[i] = level(c);
    return OK;
}
API int fmi2GetFMUstate(Odd *c, void **state) { return save(c, state); }
API int fmi2SetFMUstate(Odd *c, void *state) { return restore(c, state); }
API int fmi2FreeFMUstate(Odd *c, void **state) { (void)c; return drop(state); }
API int fmi2DoStep(Odd *c, double begin, double size, int is_final) {
    bool early = false;
    (void)is_final;
    return step(c, begin, size, &early);
}
API int fmi2GetRealStatus(Odd *c, int kind, double *value) {
    (void)kind;
    *value = c->last;
    return OK;
}
API int fmi2GetBooleanStatus(Odd *c, int kind, int *value) {
    (void)kind;
    *value = c->ended;
    return OK;
}
#else
API void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *resources,
                                      bool visible, bool logging, bool events, bool early,
                                      const uint32_t *intermediate, size_t n, void *environment,
                                      Logger logger, void *update) {
    (void)token, (void)resources, (void)visible, (void)logging, (void)events, (void)intermediate;
    (void)n, (void)update;
    Odd *odd = create(name, (void *)logger, environment);
    odd->early_allowed = early;
    return odd;
}
API void fmi3FreeInstance(void *c) { free(c); }
API int fmi3SetDebugLogging(void *c, bool on, size_t n, const char *const *words) {
    (void)c, (void)on, (void)n, (void)words;
    return OK;
}
API int fmi3EnterInitializationMode(Odd *c, bool t, double tolerance, double start, bool s, double stop) {
    (void)t, (void)tolerance, (void)s, (void)stop;
    c->time = c->last = start;
    return OK;
}
API int fmi3ExitInitializationMode(void *c) { (void)c; return OK; }
API int fmi3Terminate(void *c) { (void)c; return OK; }
API int fmi3GetFloat64(Odd *c, const uint32_t *r, size_t n, double *v, size_t m) {
    (void)m;
    return get_reals(c, r, n, v);
}
API int fmi3SetFloat64(Odd *c, const uint32_t *r, size_t n, const double *v, size_t m) {
    (void)m;
    return set_reals(c, r, n, v);
}
API int fmi3GetInt32(Odd *c, const uint32_t *r, size_t n, int32_t *v, size_t m) {
    (void)r, (void)m;
    for (size_t i = 0; i < n; i++) v[i] = c->behaviour;
    return OK;
}
API int fmi3SetInt32(Odd *c, const uint32_t *r, size_t n, const int32_t *v, size_t m) {
    (void)r, (void)m;
    for (size_t i = 0; i < n; i++) c->behaviour = v[i];
    return OK;
}
API int fmi3GetBoolean(Odd *c, const uint32_t *r, size_t n, bool *v, size_t m) {
    (void)r, (void)m;
    for (size_t i = 0; i < n; i++) v[i] = level(c);
    return OK;
}
API int fmi3GetFMUState(Odd *c, void **state) { return save(c, state); }
API int fmi3SetFMUState(Odd *c, void *state) { return restore(c, state); }
API int fmi3FreeFMUState(Odd *c, void **state) { (void)c; return drop(state); }
API int fmi3DoStep(Odd *c, double begin, double size, bool is_final, bool *event, bool *end,
                   bool *early, double *last) {
    (void)is_final;
    *event = *early = false;
    const int status = step(c, begin, size, early);
    *end = c->ended;
    *last = c->last;
    return status;
}
#endif
