/* Calls the functions of FMI 3.0 libraries again and again, as a master in C would. */
#include <stdbool.h>
#include <stddef.h>

typedef int DoStep(void *instance, double begin, double size, bool no_set_prior, bool *event_needed,
                   bool *terminate, bool *early_return, double *last_time);

/* Steps of `size` from `begin` on; returns how many succeeded. */
#ifdef _WIN32
__declspec(dllexport)
#else
__attribute__((visibility("default")))
#endif
int step_loop(DoStep *do_step, void *instance, double begin, double size, int count)
{
    int done = 0;
    for (int i = 0; i < count; i++) {
        bool event, end, early;
        double last;
        done += do_step(instance, begin + i * size, size, true, &event, &end, &early, &last) == 0;
    }
    return done;
}

typedef int Get(void *instance, const unsigned *references, size_t count, double *values,
                size_t size);
typedef int Set(void *instance, const unsigned *references, size_t count, const double *values,
                size_t size);

typedef struct {
    DoStep *step;
    Get *get;
    Set *set;
    void *instance;
    const unsigned *inputs;
    const unsigned *outputs;
} Side;

/* Steps of an axis and then of the probe that follows its motion (time and size of the step,
   position and velocity at both ends); a row of five values for each: time, position, velocity and
   the two outputs of the probe. Returns how many steps succeeded. */
#ifdef _WIN32
__declspec(dllexport)
#else
__attribute__((visibility("default")))
#endif
int couple_loop(const Side *axis, const Side *probe, double begin, double size, int count,
                double *rows)
{
    int done = 0;
    double now[2], motion[6];
    axis->get(axis->instance, axis->outputs, 2, now, 2);
    for (int i = 0; i < count; i++) {
        bool event, end, early;
        double last, *row = rows + 5 * i;
        motion[0] = begin + i * size;
        motion[1] = size;
        motion[2] = now[0];
        motion[3] = now[1];
        int wrong = axis->step(axis->instance, motion[0], size, true, &event, &end, &early, &last);
        wrong += axis->get(axis->instance, axis->outputs, 2, now, 2);
        motion[4] = row[1] = now[0];
        motion[5] = row[2] = now[1];
        wrong += probe->set(probe->instance, probe->inputs, 6, motion, 6);
        wrong += probe->step(probe->instance, motion[0], size, true, &event, &end, &early, &last);
        wrong += probe->get(probe->instance, probe->outputs, 2, row + 3, 2);
        row[0] = motion[0] + size;
        done += wrong == 0;
    }
    return done;
}
