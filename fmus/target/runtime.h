/* What a generated model gives to the runtime, and small helpers of the generated code.
 *
 * A model lives in two vectors: y (N_X states, then what follows from them at the same instant)
 * and p (parameters, inputs, discrete variables, previous values, relation memory). The functions
 * have no other memory, so that instances never meet.
 */
#ifndef AXISRIG_RUNTIME_H
#define AXISRIG_RUNTIME_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum { TYPE_FLOAT64, TYPE_INT32, TYPE_BOOLEAN, TYPE_ENUMERATION } VariableType;
/* CLASS_PARAMETER: also start values of states; both can be set before the start only. */
typedef enum { CLASS_OUTPUT, CLASS_INPUT, CLASS_PARAMETER } VariableClass;
typedef enum { IN_Y, IN_P, IS_TIME } VariableVector;

typedef struct {
    const char *name;
    VariableType type;
    VariableClass class;
    VariableVector vector;
    int index; /* of its first element */
    int count; /* elements, one after the other; 1 for a scalar */
    double min, max;
} VariableInfo;

/* What a relation keeps in its memory: whether its function is below zero, and what that means at
 * exactly zero; or the whole number below, above or towards zero of its function.
 */
typedef enum {
    ZERO_IS_FALSE,
    ZERO_IS_TRUE,
    ZERO_KEEPS,
    WHOLE_BELOW,
    WHOLE_ABOVE,
    WHOLE_INSIDE,
} RelationKind;

typedef struct {
    int memory; /* slot in p */
    RelationKind kind;
    const char *place; /* file:line */
} RelationInfo;

/* A clock: its flag in p is true at the instants offset + k*interval. */
typedef struct {
    int flag;
    double grid[3];    /* a, b, d: the instants are exactly (a + k*b)/d; d is 0 without a grid */
    const char *place; /* file:line */
} ClockInfo;

/* Generated (model.c). */
static void model_derivatives(double t, const double *restrict x, const double *restrict p,
                              double *restrict dx);
static void model_relations(double t, const double *restrict x, const double *restrict p,
                            double *restrict z);
static void model_algebraics(double t, double *restrict y, const double *restrict p);
static void model_initial(double t, double *y, double *p);
static void model_runtime(double t, const double *y, double *p);
static void model_updates(double t, const double *y, double *p, bool with_whens);
static void model_conditions(double t, const double *y, double *p);
static void model_clocks(const double *p, double *offset, double *interval);
static void model_previous(const double *y, double *p);
static const char *model_failed_assertion(double t, const double *y, const double *p);

static inline double smaller(double a, double b) { return b < a ? b : a; }
static inline double larger(double a, double b) { return b > a ? b : a; }
static inline double sign(double a) { return a > 0.0 ? 1.0 : a < 0.0 ? -1.0 : 0.0; }

/* mod(a, b) of Modelica without rounding: the result has the sign of b. */
static inline double modulo(double a, double b)
{
    const double rest = fmod(a, b);
    return rest != 0.0 && (rest < 0.0) != (b < 0.0) ? rest + b : rest;
}

#endif
