/* SPDX-License-Identifier: Apache-2.0 */
/* What a generated model and the runtime share, and small helpers of the generated code.
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
#include <stdio.h>

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
 * exactly zero; or the whole number below, above or towards zero of its function, or its sign.
 */
typedef enum {
    ZERO_IS_FALSE,
    ZERO_IS_TRUE,
    ZERO_KEEPS,
    WHOLE_BELOW,
    WHOLE_ABOVE,
    WHOLE_INSIDE,
    SIGN,
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

/* Equations that hold at once: everything in them, file:line of the first. */
typedef struct {
    const char *names;
    const char *place;
} BlockInfo;

typedef enum {
    SOLVER_OK,
    SOLVER_TERMINATED, /* the model called terminate() */
    SOLVER_FAILED,
} SolverResult;

/* What a model says while it runs; the slave hands it to the importer's logger. */
enum { N_WARNINGS = 8, WARNING_SIZE = 256, TEXT_SIZE = 768 };
typedef struct {
    int warnings;                         /* more than N_WARNINGS are only counted */
    char warning[N_WARNINGS][WARNING_SIZE];
    char text[TEXT_SIZE];                 /* of what has ended the simulation */
    int reinits;                          /* events at which a state has jumped */
    bool may_return_early, returned_early; /* of the present step: allowed, done */
} Notes;

static inline double smaller(double a, double b) { return b < a ? b : a; }
static inline double larger(double a, double b) { return b > a ? b : a; }
static inline double sign(double a) { return a > 0.0 ? 1.0 : a < 0.0 ? -1.0 : 0.0; }

/* A whole number as it is, unless it is so large that a double rounds it. */
static inline double whole(double a) { return fabs(a) <= 9007199254740992.0 ? a : NAN; }

/* mod(a, b) of Modelica without rounding: the result has the sign of b. */
static inline double modulo(double a, double b)
{
    const double rest = fmod(a, b);
    return rest != 0.0 && (rest < 0.0) != (b < 0.0) ? rest + b : rest;
}

#endif
