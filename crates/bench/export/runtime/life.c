/* The life of an instance, the same whatever it simulates. */
#include <math.h>
#include <string.h>

#include "interface.h"

/* A longer step would not end. */
static const double MOST_SAMPLES = 1e9;
/* How far a communication point may be off, in samples, and relative to the time. */
static const double TIME_SAMPLES = 1e-2, TIME_RELATIVE = 1e-9;

life *life_of(instance *i) { return &((instance_head *)i)->life; }

call_status fail(instance *i, const char *message) {
    instance_head *head = (instance_head *)i;
    if (head && head->message) head->message(head->to, STATUS_ERROR, "logStatusError", message);
    return STATUS_ERROR;
}

int allowed(instance *i, int modes, const char *call) {
    char message[200] = "this call is not allowed now: ";
    if (!i) return 0;
    if (life_of(i)->mode & modes) return 1;
    strncat(message, call, 60);
    strcat(message, life_of(i)->mode == MODE_BROKEN ? ". A step failed; reset the instance or set an earlier state"
                                                    : ". See the modes in the FMI standard");
    fail(i, message);
    return 0;
}

int is_exchange(instance *i, int modes, const char *call) {
    if (!i) return 0;
    if (life_of(i)->kind == INTERFACE_EXCHANGE) return allowed(i, modes, call);
    fail(i, "this call is for Model Exchange, but the instance is for Co-Simulation");
    return 0;
}

call_status set_times(instance *i, double start, int stop_defined, double stop) {
    life *l = life_of(i);
    if (!isfinite(start)) return fail(i, "the start time is not a number");
    if (stop_defined && !(stop >= start && isfinite(stop))) return fail(i, "the stop time is before the start time");
    l->start = l->time = start;
    l->stop_defined = stop_defined;
    l->stop = stop_defined ? stop : 0.0;
    return STATUS_OK;
}

call_status set_time(instance *i, double time) {
    if (!is_exchange(i, MODE_EVENT | MODE_CONTINUOUS, "setTime")) return STATUS_ERROR;
    if (!isfinite(time)) return fail(i, "the time is not a number");
    if (time < life_of(i)->start - 1e-9 * (1.0 + fabs(life_of(i)->start))) return fail(i, "the time is before the start time");
    life_of(i)->time = time;
    return STATUS_OK;
}

call_status enter_mode(instance *i, int from, int mode, const char *call) {
    if (!allowed(i, from, call)) return STATUS_ERROR;
    life_of(i)->mode = mode;
    return STATUS_OK;
}

const char *fault_of_step(const life *l, double from, double length, double sample_time_s) {
    double near = TIME_SAMPLES * sample_time_s + TIME_RELATIVE * fabs(l->time);
    if (!isfinite(from) || !isfinite(length)) return "the time or the length of the step is not a number";
    if (!(length > 0.0)) return "the length of the step is not above zero";
    if (from < l->time - near) return "the step begins before the present time; set an earlier state to go back";
    if (from > l->time + near) return "the step begins after the present time; steps must follow one another";
    if (l->stop_defined && from + length > l->stop + near) return "the step ends after the stop time";
    if (length > MOST_SAMPLES * sample_time_s) return "the step is longer than 1e9 samples";
    return NULL;
}

unsigned long long checksum(const void *bytes, size_t size) {
    const unsigned char *byte = (const unsigned char *)bytes;
    unsigned long long sum = 0xcbf29ce484222325ull;
    for (size_t k = 0; k < size; k++) sum = (sum ^ byte[k]) * 0x100000001b3ull;
    return sum;
}
