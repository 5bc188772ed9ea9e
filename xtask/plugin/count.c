/* Counts the instructions that interrupt handlers execute, in QEMU (TCG plugin, API 1).
 *
 *   -plugin count.so,out=FILE,h=NAME:START:END,h=...,worst=NAME        (addresses in hex, END behind the last byte)
 *
 * FILE gets a line `NAME COUNT` whenever a handler returns: the instructions between its entry and its return, both
 * included, callees included, handlers that preempted it not. At its end there are the instructions of the costliest call
 * of the handler `worst` names, as lines `at ADDRESS TIMES`.
 *
 * A handler begins when its first instruction is executed. A return instruction in its own body ends it, unless it goes
 * on with the one behind it (a return whose condition failed): a handler is entered by the hardware only, so such an
 * instruction is always a return from the exception. Where another handler begins in between, which of both it was
 * shows when that one is over, or when the first begins anew. Handlers must not end in a tail call; RTIC's don't, since
 * they restore BASEPRI last. What does not fit is counted and written as `anomalies N` at the end.
 */
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The few functions of QEMU's plugin interface that are used; Debian ships no header for it. */
typedef uint64_t plugin_id;
struct qemu_plugin_tb;
struct qemu_plugin_insn;
extern void qemu_plugin_register_vcpu_tb_trans_cb(plugin_id, void (*)(plugin_id, struct qemu_plugin_tb *));
extern void qemu_plugin_register_atexit_cb(plugin_id, void (*)(plugin_id, void *), void *);
extern void qemu_plugin_register_vcpu_insn_exec_cb(struct qemu_plugin_insn *, void (*)(unsigned, void *), int, void *);
extern size_t qemu_plugin_tb_n_insns(const struct qemu_plugin_tb *);
extern struct qemu_plugin_insn *qemu_plugin_tb_get_insn(const struct qemu_plugin_tb *, size_t);
extern uint64_t qemu_plugin_insn_vaddr(const struct qemu_plugin_insn *);
extern const void *qemu_plugin_insn_data(const struct qemu_plugin_insn *);

__attribute__((visibility("default"))) int qemu_plugin_version = 1;

enum { HANDLERS = 32, DEPTH = 32, NONE = -1 };

static struct { char name[64]; uint32_t start, end; } handlers[HANDLERS];
static int handler_count;
/* Handlers that have begun; `returned` since a return instruction, unless it goes on at `behind`. */
static struct { int handler; uint64_t count; bool returned; uint32_t behind; } running[DEPTH];
static int depth;
static uint64_t anomalies;
static FILE *out;

/* An instruction as it was translated, and how often the present call of the handler looked into has executed it. */
struct place { uint32_t at, size; int body; bool entry, returns; uint32_t times; };

/* The instructions of a call. */
struct call { struct place **places; uint32_t *times; size_t count, room; };

static int looked_into = NONE;
static uint64_t most;
static struct call present, costliest;

static void add(struct call *call, struct place *place, uint32_t times)
{
    if (call->count == call->room) {
        call->room = call->room ? call->room * 2 : 4096;
        call->places = realloc(call->places, call->room * sizeof *call->places);
        call->times = realloc(call->times, call->room * sizeof *call->times);
        if (!call->places || !call->times)
            abort();
    }
    call->places[call->count] = place;
    call->times[call->count++] = times;
}

/* The present call of the handler looked into is over. */
static void look(uint64_t count)
{
    if (count > most) {
        most = count;
        costliest.count = 0;
        for (size_t n = 0; n < present.count; n++)
            add(&costliest, present.places[n], present.places[n]->times);
    }
    for (size_t n = 0; n < present.count; n++)
        present.places[n]->times = 0;
    present.count = 0;
}

static bool is_return(uint16_t first, uint16_t second)
{
    return first == 0x4770                                                    /* bx lr */
        || (first & 0xFF00) == 0xBD00                                         /* pop {.., pc} */
        || (first == 0xE8BD && (second & 0x8000))                             /* pop.w {.., pc} */
        || (first == 0xF85D && (second & 0xFF00) == 0xFB00);                  /* ldr pc, [sp], #n */
}

/* The handler at a place of the stack is over. */
static void leave(int n)
{
    fprintf(out, "%s %llu\n", handlers[running[n].handler].name, (unsigned long long)running[n].count);
    if (running[n].handler == looked_into)
        look(running[n].count);
    depth--;
    memmove(&running[n], &running[n + 1], (size_t)(depth - n) * sizeof *running);
}

static void begin(int handler)
{
    /* one that begins anew was over when others, of whatever priority, began behind it */
    for (int n = 0; n < depth; n++) {
        if (running[n].handler == handler) {
            if (!running[n].returned)
                anomalies++;
            leave(n);
            break;
        }
    }
    if (depth == DEPTH) {
        anomalies++;
        return;
    }
    running[depth].handler = handler;
    running[depth].count = 0;
    running[depth].returned = false;
    depth++;
}

static void executed(unsigned cpu, void *data)
{
    struct place *p = data;
    (void)cpu;
    if (p->entry)
        begin(p->body);
    while (depth && running[depth - 1].returned && p->at != running[depth - 1].behind)
        leave(depth - 1);
    if (depth == 0)
        return;
    running[depth - 1].returned = false;
    running[depth - 1].count++;
    if (running[depth - 1].handler == looked_into && !p->times++)
        add(&present, p, 0);
    if (p->body != NONE && p->body != running[depth - 1].handler)
        anomalies++;
    if (p->returns && p->body == running[depth - 1].handler) {
        running[depth - 1].returned = true;
        running[depth - 1].behind = p->at + p->size;
    }
}

static void translated(plugin_id id, struct qemu_plugin_tb *tb)
{
    (void)id;
    for (size_t n = 0; n < qemu_plugin_tb_n_insns(tb); n++) {
        struct qemu_plugin_insn *insn = qemu_plugin_tb_get_insn(tb, n);
        const uint8_t *bytes = qemu_plugin_insn_data(insn);
        struct place *p = calloc(1, sizeof *p); /* lives as long as the translation may: for ever */
        if (!p)
            abort();
        uint16_t first = (uint16_t)(bytes[0] | bytes[1] << 8);
        /* near the end of a page the interface gives wrong sizes: the opcode tells */
        bool wide = first >> 11 >= 0x1D;
        uint16_t second = wide ? (uint16_t)(bytes[2] | bytes[3] << 8) : 0;
        p->at = (uint32_t)qemu_plugin_insn_vaddr(insn);
        p->size = wide ? 4 : 2;
        p->body = NONE;
        p->returns = is_return(first, second);
        for (int h = 0; h < handler_count; h++) {
            if (p->at >= handlers[h].start && p->at < handlers[h].end) {
                p->body = h;
                p->entry = p->at == handlers[h].start;
            }
        }
        qemu_plugin_register_vcpu_insn_exec_cb(insn, executed, 0, p);
    }
}

static void ended(plugin_id id, void *data)
{
    (void)id;
    (void)data;
    while (depth && running[depth - 1].returned)
        leave(depth - 1);
    for (size_t n = 0; n < costliest.count; n++)
        fprintf(out, "at %u %u\n", (unsigned)costliest.places[n]->at, (unsigned)costliest.times[n]);
    fprintf(out, "anomalies %llu\n", (unsigned long long)anomalies);
    fclose(out);
}

__attribute__((visibility("default")))
int qemu_plugin_install(plugin_id id, const void *info, int argc, char **argv)
{
    (void)info;
    for (int n = 0; n < argc; n++) {
        if (!strncmp(argv[n], "out=", 4)) {
            out = fopen(argv[n] + 4, "w");
        } else if (!strncmp(argv[n], "h=", 2) && handler_count < HANDLERS
                   && sscanf(argv[n] + 2, "%63[^:]:%x:%x", handlers[handler_count].name,
                             &handlers[handler_count].start, &handlers[handler_count].end) == 3) {
            handler_count++;
        } else if (!strncmp(argv[n], "worst=", 6)) {
            for (int h = 0; h < handler_count; h++)
                if (!strcmp(argv[n] + 6, handlers[h].name))
                    looked_into = h;
        } else {
            fprintf(stderr, "count: `%s` is not understood\n", argv[n]);
            return 1;
        }
    }
    if (!out || !handler_count) {
        fprintf(stderr, "count: out=FILE and h=NAME:START:END are wanted\n");
        return 1;
    }
    qemu_plugin_register_vcpu_tb_trans_cb(id, translated);
    qemu_plugin_register_atexit_cb(id, ended, NULL);
    return 0;
}
