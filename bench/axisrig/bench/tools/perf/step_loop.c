/* Calls fmi3DoStep of any library again and again, as a master in C would. */
#include <stdbool.h>

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
