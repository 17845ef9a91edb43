/* Lives of a slave, for valgrind: instantiate, initialize, step, save, restore, fail, free.
 *
 * life_cycle LIBRARY TOKEN LIVES REFERENCE VALUE; REFERENCE is a Float64 or Real input that can be
 * set to VALUE. Compiled with -DFMI=2 or -DFMI=3; the library is opened as an importer would.
 */
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>

#if FMI == 2
#include "fmi2Functions.h"
#define NAME(x) "fmi2" x
typedef fmi2FMUstate State;
typedef fmi2Byte Byte;
#else
#include "fmi3Functions.h"
#define NAME(x) "fmi3" x
typedef fmi3FMUState State;
typedef fmi3Byte Byte;
#endif

#define CHECK(call)                                                                                \
    if ((call) > 1) {                                                                              \
        fprintf(stderr, "%s failed\n", #call);                                                     \
        exit(1);                                                                                   \
    }
#define REFUSED(call)                                                                              \
    if ((call) <= 1) {                                                                             \
        fprintf(stderr, "%s was not refused\n", #call);                                            \
        exit(1);                                                                                   \
    }

static void *library;
static int messages;

static void *symbol(const char *name)
{
    void *const found = dlsym(library, name);
    if (found == NULL) {
        fprintf(stderr, "no %s\n", name);
        exit(1);
    }
    return found;
}

#if FMI == 2
static void log_message(void *environment, fmi2String name, fmi2Status status, fmi2String category,
                        fmi2String message, ...)
{
    (void)environment, (void)name, (void)status, (void)category, (void)message;
    messages++;
}
#define GET(x) fmi2##x##TYPE *const x = (fmi2##x##TYPE *)symbol("fmi2" #x)
#else
static void log_message(void *environment, fmi3Status status, fmi3String category,
                        fmi3String message)
{
    (void)environment, (void)status, (void)category, (void)message;
    messages++;
}
#define GET(x) fmi3##x##TYPE *const x = (fmi3##x##TYPE *)symbol("fmi3" #x)
#endif

static void steps(void *slave, double begin, int count)
{
    GET(DoStep);
    for (int i = 0; i < count; i++) {
#if FMI == 2
        CHECK(DoStep(slave, begin + 1e-3 * i, 1e-3, 1));
#else
        bool event, end, early;
        double last;
        CHECK(DoStep(slave, begin + 1e-3 * i, 1e-3, true, &event, &end, &early, &last));
#endif
    }
}

static void *born(const char *token)
{
#if FMI == 2
    static const fmi2CallbackFunctions functions = {log_message, calloc, free, NULL, NULL};
    GET(Instantiate);
    return Instantiate("life", fmi2CoSimulation, token, "", &functions, 0, 1);
#else
    GET(InstantiateCoSimulation);
    return InstantiateCoSimulation("life", token, "", false, true, false, false, NULL, 0, NULL,
                                   log_message, NULL);
#endif
}

static void begin(void *slave)
{
#if FMI == 2
    GET(SetupExperiment);
    GET(EnterInitializationMode);
    CHECK(SetupExperiment(slave, 0, 0.0, 0.0, 0, 0.0));
    CHECK(EnterInitializationMode(slave));
#else
    GET(EnterInitializationMode);
    CHECK(EnterInitializationMode(slave, false, 0.0, 0.0, false, 0.0));
#endif
    GET(ExitInitializationMode);
    CHECK(ExitInitializationMode(slave));
}

static void states(void *slave)
{
    State state = NULL, copy = NULL;
    size_t size;
#if FMI == 2
    GET(GetFMUstate);
    GET(SetFMUstate);
    GET(FreeFMUstate);
    GET(SerializedFMUstateSize);
    GET(SerializeFMUstate);
    GET(DeSerializeFMUstate);
    CHECK(GetFMUstate(slave, &state));
    CHECK(SerializedFMUstateSize(slave, state, &size));
    Byte *const bytes = malloc(size);
    CHECK(SerializeFMUstate(slave, state, bytes, size));
    CHECK(DeSerializeFMUstate(slave, bytes, size, &copy));
    steps(slave, 3e-3, 1);
    CHECK(SetFMUstate(slave, copy));
    CHECK(FreeFMUstate(slave, &state));
    CHECK(FreeFMUstate(slave, &copy));
#else
    GET(GetFMUState);
    GET(SetFMUState);
    GET(FreeFMUState);
    GET(SerializedFMUStateSize);
    GET(SerializeFMUState);
    GET(DeserializeFMUState);
    CHECK(GetFMUState(slave, &state));
    CHECK(SerializedFMUStateSize(slave, state, &size));
    Byte *const bytes = malloc(size);
    CHECK(SerializeFMUState(slave, state, bytes, size));
    CHECK(DeserializeFMUState(slave, bytes, size, &copy));
    steps(slave, 3e-3, 1);
    CHECK(SetFMUState(slave, copy));
    CHECK(FreeFMUState(slave, &state));
    CHECK(FreeFMUState(slave, &copy));
#endif
    free(bytes);
}

static void values(void *slave, unsigned reference, double value)
{
    double read = 0.0, nan = strtod("nan", NULL);
#if FMI == 2
    GET(SetReal);
    GET(GetReal);
    CHECK(SetReal(slave, &reference, 1, &value));
    REFUSED(SetReal(slave, &reference, 1, &nan));
    CHECK(GetReal(slave, &reference, 1, &read));
#else
    GET(SetFloat64);
    GET(GetFloat64);
    CHECK(SetFloat64(slave, &reference, 1, &value, 1));
    REFUSED(SetFloat64(slave, &reference, 1, &nan, 1));
    CHECK(GetFloat64(slave, &reference, 1, &read, 1));
#endif
    if (read != value) {
        fprintf(stderr, "set %g, read %g\n", value, read);
        exit(1);
    }
}

int main(int count, char **words)
{
    if (count != 6 || (library = dlopen(words[1], RTLD_NOW)) == NULL) {
        fprintf(stderr, "usage, or no library: %s\n", count > 1 ? dlerror() : "");
        return 1;
    }
    const int lives = atoi(words[3]);
    for (int life = 0; life < lives; life++) {
        GET(Terminate);
        GET(Reset);
        GET(FreeInstance);
        if (born("of another FMU") != NULL) {
            return 1;
        }
        void *const slave = born(words[2]), *const other = born(words[2]);
        REFUSED(Terminate(slave));
        begin(slave);
        values(slave, (unsigned)atoi(words[4]), atof(words[5]));
        steps(slave, 0.0, 3);
        states(slave);
        steps(slave, 3e-3, 1);
        CHECK(Terminate(slave));
        CHECK(Reset(slave));
        begin(slave);
        steps(slave, 0.0, 1);
        FreeInstance(slave); /* without fmi2Terminate: an importer that fails does so */
        begin(other);
        CHECK(Terminate(other));
        FreeInstance(other);
    }
    dlclose(library);
    printf("%d lives, %d messages\n", lives, messages);
    return messages == 3 * lives ? 0 : 1;
}
