/* Equations that hold at once: linear ones by elimination, others by Newton's method.
 *
 * Sources: elimination with scaled pivots, G. Golub, C. Van Loan, Matrix Computations, section 3.4;
 * damping by the natural level, P. Deuflhard, Newton Methods for Nonlinear Problems, section 3.3.
 */
#include <string.h>

#define NEWTON_STEPS 100
#define NEWTON_CLOSE 1e-9  /* relative: from here on every step doubles the correct digits */
#define NEWTON_POLISH 4    /* steps from there on */
#define NEWTON_DAMPING 1e-8 /* smallest share of a step */

typedef void (*BlockFunction)(double t, const double *input, const double *u, double *residual,
                              double *slope);

/* Solve a x = b for n unknowns; x replaces b. False when the matrix is singular or not finite. */
static inline bool solve_linear(int n, double *a, double *b)
{
    for (int k = 0; k < n; k++) {
        int pivot = -1;
        double best = 0.0;
        for (int i = k; i < n; i++) {
            double scale = 0.0;
            for (int j = k; j < n; j++) {
                scale = larger(scale, fabs(a[i * n + j]));
            }
            const double share = scale > 0.0 ? fabs(a[i * n + k]) / scale : 0.0;
            if (share > best) {
                best = share;
                pivot = i;
            }
        }
        if (pivot < 0) {
            return false;
        }
        for (int j = k; j < n && pivot != k; j++) {
            const double kept = a[k * n + j];
            a[k * n + j] = a[pivot * n + j];
            a[pivot * n + j] = kept;
        }
        const double right = b[k];
        b[k] = b[pivot];
        b[pivot] = right;
        for (int i = k + 1; i < n; i++) {
            const double factor = a[i * n + k] / a[k * n + k];
            for (int j = k + 1; j < n; j++) {
                a[i * n + j] -= factor * a[k * n + j];
            }
            b[i] -= factor * b[k];
        }
    }
    for (int i = n - 1; i >= 0; i--) {
        for (int j = i + 1; j < n; j++) {
            b[i] -= a[i * n + j] * b[j];
        }
        b[i] /= a[i * n + i];
        if (!isfinite(b[i])) {
            return false;
        }
    }
    return true;
}

#if LARGEST_BLOCK > 0
/* The largest change in terms of its unknown; near zero in terms of 1. */
static double relative(int n, const double *change, const double *u)
{
    double most = 0.0;
    for (int i = 0; i < n; i++) {
        most = larger(most, fabs(change[i]) / larger(fabs(u[i]), 1.0));
    }
    return most;
}

/* Euclidean length of a change, every unknown in terms of its size. */
static double length(int n, const double *change, const double *u)
{
    double sum = 0.0;
    for (int i = 0; i < n; i++) {
        const double part = change[i] / larger(fabs(u[i]), 1e-12);
        sum += part * part;
    }
    return sqrt(sum);
}

static bool all_finite(int n, const double *values)
{
    for (int i = 0; i < n; i++) {
        if (!isfinite(values[i])) {
            return false;
        }
    }
    return true;
}

/* The step that Newton's method takes from a residual; false without one. */
static bool newton_step(int n, const double *slope, const double *residual, double *step)
{
    double matrix[LARGEST_BLOCK * LARGEST_BLOCK];
    memcpy(matrix, slope, (size_t)(n * n) * sizeof *matrix);
    memcpy(step, residual, (size_t)n * sizeof *step);
    return solve_linear(n, matrix, step);
}

/* Find residual(u) = 0 from u. A step is shortened until the next one is shorter. */
static bool newton_from(BlockFunction block, double t, const double *input, double *u, int n)
{
    double residual[LARGEST_BLOCK], slope[LARGEST_BLOCK * LARGEST_BLOCK], step[LARGEST_BLOCK];
    int polished = 0;
    double last = INFINITY;
    block(t, input, u, residual, slope);
    for (int k = 0; k < NEWTON_STEPS; k++) {
        if (!all_finite(n, residual) || !newton_step(n, slope, residual, step)) {
            return false;
        }
        const double now = length(n, step, u);
        if (now == 0.0) {
            return true;
        }
        const bool close = relative(n, step, u) < NEWTON_CLOSE;
        if (close && (polished > NEWTON_POLISH || now > 0.5 * last)) {
            return true; /* only rounding moves it now */
        }
        polished += close ? 1 : 0;
        last = close ? now : INFINITY;
        double share = 1.0;
        for (;; share *= 0.5) {
            double to[LARGEST_BLOCK], there[LARGEST_BLOCK], next[LARGEST_BLOCK];
            double slope_there[LARGEST_BLOCK * LARGEST_BLOCK];
            for (int i = 0; i < n; i++) {
                to[i] = u[i] - share * step[i];
            }
            block(t, input, to, there, slope_there);
            const bool usable = all_finite(n, there) && newton_step(n, slope, there, next);
            if (usable && (close || length(n, next, u) <= (1.0 - 0.25 * share) * now)) {
                memcpy(u, to, (size_t)n * sizeof *u);
                memcpy(residual, there, (size_t)n * sizeof *residual);
                memcpy(slope, slope_there, (size_t)(n * n) * sizeof *slope);
                break;
            }
            if (share < NEWTON_DAMPING) {
                return false;
            }
        }
    }
    return false;
}

/* Find residual(u) = 0 from the guess in u, or, where the search gets stuck, from beside it. */
static bool newton(BlockFunction block, double t, const double *input, double *u, int n)
{
    static const double shifts[] = {0.0, 1e-3, 0.1, 1.0, -0.1, -1.0};
    for (size_t k = 0; k < sizeof shifts / sizeof shifts[0]; k++) {
        double found[LARGEST_BLOCK];
        for (int i = 0; i < n; i++) {
            found[i] = u[i] + shifts[k] * (1.0 + fabs(u[i]));
        }
        if (newton_from(block, t, input, found, n)) {
            memcpy(u, found, (size_t)n * sizeof *u);
            return true;
        }
    }
    return false;
}
#endif
