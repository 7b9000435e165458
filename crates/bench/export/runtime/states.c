/* Kept states of an instance, and their bytes. */
#include <stdlib.h>
#include <string.h>

#include "instance.h"

/* Tells the layout: its version and its size. */
static unsigned long long mark(void) { return 0x64796e6f69640001ull ^ (unsigned long long)sizeof(kept_state) << 20; }

static unsigned long long check_of(const kept_state *kept) {
    return checksum(&kept->life, sizeof *kept - offsetof(kept_state, life));
}

size_t size_of_state(const instance *i) { return i ? sizeof(kept_state) : 0; }

call_status keep_state(instance *i, kept_state **kept) {
    if (!i) return STATUS_ERROR;
    if (!kept) return fail(i, "there is no room for the state");
    if (!*kept) *kept = (kept_state *)calloc(1, sizeof **kept);
    if (!*kept) return fail(i, "there is no memory for the state");
    (*kept)->mark = mark();
    (*kept)->life = i->head.life;
    (*kept)->now = i->now;
    (*kept)->bench = i->bench.state;
    (*kept)->check = 0; /* of bytes only; see serialize_state */
    return STATUS_OK;
}

call_status restore_state(instance *i, const kept_state *kept) {
    if (!i) return STATUS_ERROR;
    if (!kept || kept->mark != mark()) return fail(i, "this is no state of such an instance");
    if (kept->life.kind != i->head.life.kind) return fail(i, "the state is of another interface type");
    if (kept->now.draw > i->model.draws) return fail(i, "the state has a draw that this model does not have");
    i->head.life = kept->life;
    i->now = kept->now;
    i->bench.state = kept->bench;
    if (i->now.fresh || bench_prepare(&i->bench)) return STATUS_OK;
    i->head.life.mode = MODE_BROKEN;
    return fail(i, "the parameters of the state cannot be used");
}

call_status serialize_state(instance *i, const kept_state *kept, void *bytes, size_t size) {
    kept_state copy;
    if (!i) return STATUS_ERROR;
    if (!kept || kept->mark != mark() || !bytes) return fail(i, "this is no state of such an instance");
    if (size < sizeof copy) return fail(i, "the room for the bytes of the state is too small");
    memcpy(&copy, kept, sizeof copy);
    copy.check = check_of(&copy);
    memcpy(bytes, &copy, sizeof copy);
    return STATUS_OK;
}

call_status deserialize_state(instance *i, const void *bytes, size_t size, kept_state **kept) {
    kept_state *copy;
    if (!i) return STATUS_ERROR;
    if (!bytes || !kept || size < sizeof *copy) return fail(i, "these are not the bytes of a state");
    copy = (kept_state *)malloc(sizeof *copy);
    if (!copy) return fail(i, "there is no memory for the state");
    memcpy(copy, bytes, sizeof *copy);
    if (copy->mark != mark() || copy->check != check_of(copy)) {
        free(copy);
        return fail(i, "these are not the bytes of a state, or they are damaged");
    }
    *kept = copy;
    return STATUS_OK;
}
