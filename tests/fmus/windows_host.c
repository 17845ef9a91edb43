/* Loads the library of an FMU on Windows, steps it, and prints the bits of its outputs.
 *
 * host LIBRARY TOKEN STEP_NS COUNT [s:REFERENCE:TYPE:VALUE ...] [o:REFERENCE:TYPE ...]
 * TYPE: r real, i integer, b Boolean. A line for the start and for each step.
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <windows.h>

#if FMI == 3
#include "fmi3Functions.h"
#define REAL "Float64"
#define INTEGER "Int32"
typedef fmi3Instance Instance;
typedef fmi3Boolean Truth;
#define COUNT_OF_VALUES , size_t
#define ONE_VALUE , 1
#else
#include "fmi2Functions.h"
#define REAL "Real"
#define INTEGER "Integer"
typedef fmi2Component Instance;
typedef fmi2Boolean Truth;
#define COUNT_OF_VALUES
#define ONE_VALUE
#endif
#define TEXT_OF(x) #x
#define PREFIX_OF(version) "fmi" TEXT_OF(version)
#define PREFIX PREFIX_OF(FMI)

typedef int (*Access)(Instance, const unsigned *, size_t, void * COUNT_OF_VALUES);

static HMODULE library;

static void *function(const char *name)
{
    char whole[64];
    snprintf(whole, sizeof whole, PREFIX "%s", name);
    void *const found = (void *)GetProcAddress(library, whole);
    if (found == NULL) {
        fprintf(stderr, "no function %s\n", whole);
        exit(3);
    }
    return found;
}

static void expect(int status, const char *what)
{
    if (status != 0) {
        fprintf(stderr, "%s: status %d\n", what, status);
        exit(4);
    }
}

static Access access_to(const char *verb, char type)
{
    char name[32];
    snprintf(name, sizeof name, "%s%s", verb, type == 'r' ? REAL : type == 'i' ? INTEGER : "Boolean");
    return (Access)function(name);
}

static void set(Instance me, unsigned reference, char type, double value)
{
    const int32_t whole = (int32_t)value;
    const Truth truth = value != 0.0;
    const void *const given = type == 'r' ? (const void *)&value : type == 'i' ? (const void *)&whole : (const void *)&truth;
    expect(access_to("Set", type)(me, &reference, 1, (void *)given ONE_VALUE), "set");
}

static double get(Instance me, unsigned reference, char type)
{
    double value = 0.0;
    int32_t whole = 0;
    Truth truth = 0;
    void *const taken = type == 'r' ? (void *)&value : type == 'i' ? (void *)&whole : (void *)&truth;
    expect(access_to("Get", type)(me, &reference, 1, taken ONE_VALUE), "get");
    return type == 'r' ? value : type == 'i' ? whole : truth != 0;
}

static void print(Instance me, int count, char **words)
{
    for (int i = 0; i < count; i++) {
        unsigned reference;
        char type;
        if (sscanf(words[i], "o:%u:%c", &reference, &type) == 2) {
            const double value = get(me, reference, type);
            uint64_t bits;
            memcpy(&bits, &value, sizeof bits);
            printf("%016llx ", (unsigned long long)bits);
        }
    }
    printf("\n");
}

#if FMI == 3
static Instance instantiate(const char *token)
{
    fmi3InstantiateCoSimulationTYPE *const make = (fmi3InstantiateCoSimulationTYPE *)function("InstantiateCoSimulation");
    const Instance me = make("host", token, "", fmi3False, fmi3True, fmi3False, fmi3False, NULL, 0, NULL, NULL, NULL);
    return me;
}
static void enter(Instance me)
{
    expect(((fmi3EnterInitializationModeTYPE *)function("EnterInitializationMode"))(me, fmi3False, 0, 0, fmi3False, 0), "enter");
}
static void go(Instance me, double at, double size)
{
    fmi3Boolean event, end, early;
    double last;
    expect(((fmi3DoStepTYPE *)function("DoStep"))(me, at, size, fmi3True, &event, &end, &early, &last), "step");
}
#else
static void log_(fmi2ComponentEnvironment e, fmi2String n, fmi2Status s, fmi2String c, fmi2String m, ...)
{
    (void)e, (void)n, (void)s, (void)c;
    fprintf(stderr, "%s\n", m);
}
static Instance instantiate(const char *token)
{
    static const fmi2CallbackFunctions functions = {log_, calloc, free, NULL, NULL};
    return ((fmi2InstantiateTYPE *)function("Instantiate"))("host", fmi2CoSimulation, token, "", &functions, fmi2False, fmi2False);
}
static void enter(Instance me)
{
    expect(((fmi2SetupExperimentTYPE *)function("SetupExperiment"))(me, fmi2False, 0, 0, fmi2False, 0), "setup");
    expect(((fmi2EnterInitializationModeTYPE *)function("EnterInitializationMode"))(me), "enter");
}
static void go(Instance me, double at, double size)
{
    expect(((fmi2DoStepTYPE *)function("DoStep"))(me, at, size, fmi2True), "step");
}
#endif

int main(int count, char **words)
{
    if (count < 5 || (library = LoadLibraryA(words[1])) == NULL) {
        fprintf(stderr, "the library does not load\n");
        return 2;
    }
    const Instance me = instantiate(words[2]);
    if (me == NULL) {
        fprintf(stderr, "no instance\n");
        return 2;
    }
    const long long step_ns = atoll(words[3]), steps = atoll(words[4]);
    for (int i = 5; i < count; i++) {
        unsigned reference;
        char type;
        double value;
        if (sscanf(words[i], "s:%u:%c:%lf", &reference, &type, &value) == 3) {
            set(me, reference, type, value);
        }
    }
    enter(me);
    expect(((int (*)(Instance))function("ExitInitializationMode"))(me), "exit");
    print(me, count - 5, words + 5);
    for (long long k = 0; k < steps; k++) {
        const double at = (double)(k * step_ns) * 1e-9;
        go(me, at, (double)step_ns * 1e-9);
        print(me, count - 5, words + 5);
    }
    expect(((int (*)(Instance))function("Terminate"))(me), "terminate");
    ((void (*)(Instance))function("FreeInstance"))(me);
    return 0;
}
