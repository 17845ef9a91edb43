/* The functions of FMI 2.0 or 3.0 (-DFMI=2 or -DFMI=3) over a model of a few numbers and one level.

   A model file includes this and defines defaults(), start(), level() and step(). */

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { OK, WARNING, DISCARD, ERROR };

typedef struct {
    double real[16];
    int32_t behaviour;
    double time, last, own; /* own: where a model with steps of its own has come */
    bool ended, early_allowed;
    char text[64];
    const char *name;
    void *environment;
    void *logger;
} Instance;

static void defaults(Instance *instance);
/* At the end of the initialisation. */
static void start(Instance *instance);
static bool level(const Instance *instance);
/* One step; *early is set when it ends before its end with status ok. */
static int step(Instance *instance, double begin, double size, bool *early);

#if FMI == 2
typedef void (*Logger)(void *, const char *, int, const char *, const char *, ...);
typedef struct {
    Logger logger;
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void *finished;
    void *environment;
} Callbacks;
static void say(Instance *instance, int status, const char *text) {
    ((Logger)instance->logger)(instance->environment, instance->name, status, "trouble", "%s at %d ms", text,
                          (int)lround(instance->time * 1e3));
}
#else
typedef void (*Logger)(void *, int, const char *, const char *);
static void say(Instance *instance, int status, const char *text) {
    if (instance->logger) ((Logger)instance->logger)(instance->environment, status, "trouble", text);
}
#endif

static int get_reals(Instance *instance, const uint32_t *r, size_t n, double *value) {
    for (size_t i = 0; i < n; i++) value[i] = instance->real[r[i]];
    return OK;
}
static int set_reals(Instance *instance, const uint32_t *r, size_t n, const double *value) {
    for (size_t i = 0; i < n; i++) instance->real[r[i]] = value[i];
    return OK;
}
static Instance *create(const char *name, void *logger, void *environment) {
    Instance *instance = calloc(1, sizeof(Instance));
    defaults(instance);
    instance->name = name;
    instance->logger = logger;
    instance->environment = environment;
    return instance;
}
static int save(Instance *instance, void **state) {
    if (!*state) *state = malloc(sizeof(Instance));
    memcpy(*state, instance, sizeof(Instance));
    return OK;
}
static int restore(Instance *instance, void *state) {
    memcpy(instance, state, sizeof(Instance));
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
API int fmi2SetupExperiment(Instance *c, int t, double tolerance, double start, int s, double stop) {
    (void)t, (void)tolerance, (void)s, (void)stop;
    c->time = c->last = start;
    return OK;
}
API int fmi2EnterInitializationMode(void *c) { (void)c; return OK; }
API int fmi2ExitInitializationMode(Instance *c) { start(c); return OK; }
API int fmi2Terminate(void *c) { (void)c; return OK; }
API int fmi2GetReal(Instance *c, const uint32_t *r, size_t n, double *v) { return get_reals(c, r, n, v); }
API int fmi2SetReal(Instance *c, const uint32_t *r, size_t n, const double *v) { return set_reals(c, r, n, v); }
API int fmi2GetInteger(Instance *c, const uint32_t *r, size_t n, int32_t *v) {
    (void)r;
    for (size_t i = 0; i < n; i++) v[i] = c->behaviour;
    return OK;
}
API int fmi2SetInteger(Instance *c, const uint32_t *r, size_t n, const int32_t *v) {
    (void)r;
    for (size_t i = 0; i < n; i++) c->behaviour = v[i];
    return OK;
}
API int fmi2SetString(Instance *c, const uint32_t *r, size_t n, const char *const *v) {
    (void)r;
    for (size_t i = 0; i < n; i++) strncpy(c->text, v[i], sizeof c->text - 1);
    return OK;
}
API int fmi2GetBoolean(Instance *c, const uint32_t *r, size_t n, int *v) {
    (void)r;
    for (size_t i = 0; i < n; i++) v[i] = level(c);
    return OK;
}
API int fmi2GetFMUstate(Instance *c, void **state) { return save(c, state); }
API int fmi2SetFMUstate(Instance *c, void *state) { return restore(c, state); }
API int fmi2FreeFMUstate(Instance *c, void **state) { (void)c; return drop(state); }
API int fmi2DoStep(Instance *c, double begin, double size, int is_final) {
    bool early = false;
    (void)is_final;
    return step(c, begin, size, &early);
}
API int fmi2GetRealStatus(Instance *c, int kind, double *value) {
    (void)kind;
    *value = c->last;
    return c->ended && isnan(c->last) ? DISCARD : OK;
}
API int fmi2GetBooleanStatus(Instance *c, int kind, int *value) {
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
    Instance *instance = create(name, (void *)logger, environment);
    instance->early_allowed = early;
    return instance;
}
API void fmi3FreeInstance(void *c) { free(c); }
API int fmi3SetDebugLogging(void *c, bool on, size_t n, const char *const *words) {
    (void)c, (void)on, (void)n, (void)words;
    return OK;
}
API int fmi3EnterInitializationMode(Instance *c, bool t, double tolerance, double start, bool s, double stop) {
    (void)t, (void)tolerance, (void)s, (void)stop;
    c->time = c->last = start;
    return OK;
}
API int fmi3ExitInitializationMode(Instance *c) { start(c); return OK; }
API int fmi3Terminate(void *c) { (void)c; return OK; }
API int fmi3GetFloat64(Instance *c, const uint32_t *r, size_t n, double *v, size_t m) {
    (void)m;
    return get_reals(c, r, n, v);
}
API int fmi3SetFloat64(Instance *c, const uint32_t *r, size_t n, const double *v, size_t m) {
    (void)m;
    return set_reals(c, r, n, v);
}
API int fmi3GetInt32(Instance *c, const uint32_t *r, size_t n, int32_t *v, size_t m) {
    (void)r, (void)m;
    for (size_t i = 0; i < n; i++) v[i] = c->behaviour;
    return OK;
}
API int fmi3SetInt32(Instance *c, const uint32_t *r, size_t n, const int32_t *v, size_t m) {
    (void)r, (void)m;
    for (size_t i = 0; i < n; i++) c->behaviour = v[i];
    return OK;
}
API int fmi3SetInt64(Instance *c, const uint32_t *r, size_t n, const int64_t *v, size_t m) {
    (void)r, (void)m;
    for (size_t i = 0; i < n; i++) c->behaviour = (int32_t)v[i];
    return OK;
}
API int fmi3SetString(Instance *c, const uint32_t *r, size_t n, const char *const *v, size_t m) {
    (void)r, (void)m;
    for (size_t i = 0; i < n; i++) strncpy(c->text, v[i], sizeof c->text - 1);
    return OK;
}
API int fmi3GetBoolean(Instance *c, const uint32_t *r, size_t n, bool *v, size_t m) {
    (void)r, (void)m;
    for (size_t i = 0; i < n; i++) v[i] = level(c);
    return OK;
}
API int fmi3GetFMUState(Instance *c, void **state) { return save(c, state); }
API int fmi3SetFMUState(Instance *c, void *state) { return restore(c, state); }
API int fmi3FreeFMUState(Instance *c, void **state) { (void)c; return drop(state); }
API int fmi3DoStep(Instance *c, double begin, double size, bool is_final, bool *event, bool *end,
                   bool *early, double *last) {
    (void)is_final;
    *event = *early = false;
    const int status = step(c, begin, size, early);
    *end = c->ended;
    *last = c->last;
    return status;
}
#endif
